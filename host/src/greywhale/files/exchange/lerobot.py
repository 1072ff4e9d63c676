"""Writes logs as a LeRobot dataset, format v3.0: one log is one episode.

The layout, the names and the way in which episodes' statistics become the dataset's are those of lerobot 0.6.1
(datasets/dataset_metadata.py, compute_stats.py). pyarrow comes with the extra `lerobot`.
"""

from __future__ import annotations

import json
import logging
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from greywhale.base.errors import BadUsage, UserError
from greywhale.base.formats.whole import whole_folder
from greywhale.files.exchange.lerobot_frames import Episode, Form, frames_of, names_of
from greywhale.files.exchange.recording import CHUNK_ROWS, ExportOptions, Recording
from greywhale.protocol.joints import require_same

FPS = 30
ROBOT_TYPE = "greywhale"
WINDOW = "observation.joints_window"
_VERSION = "v3.0"
_FILES_PER_CHUNK, _MOST_MB = 1000, 100
_FILE = "chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
_DATA, _EPISODES = f"data/{_FILE}", f"meta/episodes/{_FILE}"
_QUANTILES = {"q01": 0.01, "q10": 0.1, "q50": 0.5, "q90": 0.9, "q99": 0.99}
_COUNTERS = {"timestamp": "float32", **dict.fromkeys(("frame_index", "episode_index", "index", "task_index"), "int64")}

logger = logging.getLogger(__name__)

Stats = dict[str, dict[str, NDArray[Any]]]


def write(recordings: Iterable[Recording], out: Path, options: ExportOptions, most_mb: float = _MOST_MB) -> list[Path]:
    """Write a dataset into the folder `out`, one episode a log; a data file ends before it has `most_mb` MiB.

    UserError where a log names no task, gives no episode, or differs from the first in joints or its samples' rate.
    """
    fps = options.fps or FPS
    with whole_folder(out) as folder, _Dataset(folder, fps, most_mb) as dataset:
        for one in recordings:
            dataset.add(one.log.name, frames_of(one, fps), _task(one, options))
        dataset.finish()
    return [out]


def _task(recording: Recording, options: ExportOptions) -> str:
    task = recording.log.facts.get("task") if options.task is None else options.task
    if not task:
        raise BadUsage(f"{recording.log.name}: this log names no task, which every episode has; give --task TEXT.")
    return task


class _Dataset:
    """A dataset that is being written into a folder, an episode after another; a context that closes its file."""

    def __init__(self, folder: Path, fps: int, most_mb: float) -> None:
        self.folder, self.fps, self.most_mb = folder, fps, most_mb
        self.rows: list[dict[str, Any]] = []  # of the episodes' table
        self.frames = 0
        self._tasks: dict[str, int] = {}
        self._stats: list[Stats] = []
        self._like: tuple[str, Form] | None = None  # the first log, which all others must be like
        self._file: Any = None
        self._path, self._number, self._frames_in_file = folder, -1, 0

    def __enter__(self) -> _Dataset:
        return self

    def __exit__(self, *error: object) -> None:
        if self._file is not None:
            self._file.close()
            self._file = None

    def add(self, name: str, episode: Episode, task: str) -> None:
        """Append an episode."""
        self._like = self._like or (name, episode.form)
        _require_like(*self._like, name, episode.form)
        for remark in episode.remarks:
            logger.warning("%s", remark)
        count, number = len(episode.places), len(self.rows)
        frame = np.arange(count)
        counters: dict[str, NDArray[Any]] = {
            "timestamp": (frame / self.fps).astype(np.float32),
            "frame_index": frame,
            "episode_index": np.full(count, number),
            "index": self.frames + frame,
            "task_index": np.full(count, self._tasks.setdefault(task, len(self._tasks))),
        }
        self._write(episode, counters)
        each: dict[str, Iterable[NDArray[Any]]] = {
            "action": episode.each_action(),
            "observation.state": episode.each_state(),
            WINDOW: episode.each_window(),
            **{key: [values] for key, values in counters.items()},
        }
        stats = {key: _statistics(components, count) for key, components in each.items()}
        self._stats.append(stats)
        self.rows.append(
            {
                "episode_index": number,
                "tasks": [task],
                "length": count,
                **_place("data", self._number),
                "dataset_from_index": self.frames,
                "dataset_to_index": self.frames + count,
                **{f"stats/{key}/{one}": value.tolist() for key, of in stats.items() for one, value in of.items()},
                **_place("meta/episodes", 0),
            }
        )
        self.frames += count

    def finish(self) -> None:
        """Write what is known at the end: episodes, tasks, statistics, and the description of all."""
        import pyarrow as pa
        import pyarrow.parquet as pq

        assert self._like is not None
        episodes = self.folder / _EPISODES.format(chunk_index=0, file_index=0)
        episodes.parent.mkdir(parents=True)
        pq.write_table(pa.Table.from_pylist(self.rows), episodes)
        tasks = pa.table({"task_index": list(self._tasks.values()), "task": list(self._tasks)})
        pq.write_table(
            tasks.replace_schema_metadata({"pandas": json.dumps(_TASK_IS_INDEX)}), self._meta("tasks.parquet")
        )
        self._write_json("stats.json", {key: _aggregate([one[key] for one in self._stats]) for key in self._stats[0]})
        self._write_json("info.json", self._info(self._like[1]))

    def _write(self, episode: Episode, counters: dict[str, NDArray[Any]]) -> None:
        """Append the frames to the data file, or to the next one where this would grow too large."""
        count = len(episode.places)
        size = self._path.stat().st_size if self._file is not None else 0
        if self._file is None or size * (1 + count / self._frames_in_file) >= self.most_mb * (1 << 20):
            self.__exit__()
            self._number, self._frames_in_file = self._number + 1, 0
            chunk, file = divmod(self._number, _FILES_PER_CHUNK)
            self._path = self.folder / _DATA.format(chunk_index=chunk, file_index=file)
            self._path.parent.mkdir(parents=True, exist_ok=True)
        at_once = max(1, CHUNK_ROWS // episode.form.samples)
        for begin in range(0, count, at_once):
            self._append(episode, counters, slice(begin, begin + at_once))
        self._frames_in_file += count

    def _append(self, episode: Episode, counters: dict[str, NDArray[Any]], frames: slice) -> None:
        """Append some of an episode's frames to the data file."""
        import pyarrow as pa
        import pyarrow.parquet as pq

        window = episode.windows(frames)
        columns = {"action": episode.actions(frames), "observation.state": window[:, -1], WINDOW: window}
        columns |= {key: values[frames] for key, values in counters.items()}
        table = pa.table({key: _column(values) for key, values in columns.items()})
        if self._file is None:
            self._file = pq.ParquetWriter(self._path, table.schema)
        self._file.write_table(table)

    def _info(self, like: Form) -> dict[str, Any]:
        actions, states = names_of(like.joints, "pos"), list(like.components)
        features: dict[str, Any] = {
            "action": {"dtype": "float32", "shape": [len(actions)], "names": actions},
            "observation.state": {"dtype": "float32", "shape": [len(states)], "names": states},
            WINDOW: {"dtype": "float32", "shape": [like.samples, len(states)], "names": ["sample", "component"]},
            **{key: {"dtype": dtype, "shape": [1], "names": None} for key, dtype in _COUNTERS.items()},
        }
        return {
            "codebase_version": _VERSION,
            "fps": self.fps,
            "features": features,
            "total_episodes": len(self.rows),
            "total_frames": self.frames,
            "total_tasks": len(self._tasks),
            "chunks_size": _FILES_PER_CHUNK,
            "data_files_size_in_mb": _MOST_MB,
            "video_files_size_in_mb": 200,
            "data_path": _DATA,
            "video_path": None,
            "robot_type": ROBOT_TYPE,
            "splits": {"train": f"0:{len(self.rows)}"},
        }

    def _meta(self, name: str) -> Path:
        return self.folder / "meta" / name

    def _write_json(self, name: str, value: object) -> None:
        self._meta(name).write_text(json.dumps(value, indent=4, ensure_ascii=False) + "\n", encoding="utf-8")


# Without it pandas, and so lerobot, would number the tasks instead of naming them.
_TASK_IS_INDEX = {
    "index_columns": ["task"],
    "column_indexes": [],
    "columns": [
        {"name": name, "field_name": name, "pandas_type": kind, "numpy_type": numpy_kind, "metadata": None}
        for name, kind, numpy_kind in (("task_index", "int64", "int64"), ("task", "unicode", "object"))
    ],
    "pandas_version": "2.0.0",
}


def _require_like(first: str, one: Form, name: str, other: Form) -> None:
    require_same(first, one.joints, name, other.joints)
    if one.components != other.components:
        raise UserError(f"{name}: its components are not those of {first}; export them into two datasets.")
    if one.every_ticks != other.every_ticks:
        raise UserError(
            f"{name}: it has a sample every {other.every_ticks} ms, but {first} every {one.every_ticks} ms, and the "
            "windows of a dataset are all alike; export them into two."
        )


def _place(where: str, number: int) -> dict[str, int]:
    chunk, file = divmod(number, _FILES_PER_CHUNK)
    return {f"{where}/chunk_index": chunk, f"{where}/file_index": file}


def _column(values: NDArray[Any]) -> Any:
    """An Arrow column of scalars, of vectors of one length, or of lists of vectors, as lerobot's writer has them."""
    import pyarrow as pa

    if values.ndim > 1 and values.shape[1:] == (1,):
        values = values[:, 0]
    flat = pa.array(values.reshape(-1))
    if values.ndim == 1:
        return flat
    if values.ndim == 2:
        return pa.FixedSizeListArray.from_arrays(flat, values.shape[1])
    frames, samples, components = values.shape
    rows = pa.ListArray.from_arrays(pa.array(np.arange(frames * samples + 1, dtype=np.int32) * components), flat)
    return pa.ListArray.from_arrays(pa.array(np.arange(frames + 1, dtype=np.int32) * samples), rows)


def _statistics(components: Iterable[NDArray[Any]], frames: int) -> dict[str, NDArray[Any]]:
    """An episode's statistics of each component, of a window over all its samples; `count` counts frames."""
    each = [_statistics_of(one.astype(np.float64).ravel()) for one in components]
    found = {name: np.array([one[name] for one in each]) for name in each[0]}
    return {**found, "count": np.array([frames])}


def _statistics_of(values: NDArray[np.float64]) -> dict[str, Any]:
    quantiles = np.quantile(values, list(_QUANTILES.values()))
    extremes = {"min": values.min(), "max": values.max(), "mean": values.mean(), "std": values.std()}
    return {**extremes, **dict(zip(_QUANTILES, quantiles, strict=True))}


def _aggregate(episodes: list[dict[str, NDArray[Any]]]) -> dict[str, list[float]]:
    """The statistics of all episodes; a quantile is the mean of theirs by frames, as lerobot has it."""
    count = np.array([one["count"] for one in episodes])

    def mean(values: list[NDArray[Any]]) -> NDArray[Any]:
        summed: NDArray[Any] = (np.stack(values) * count).sum(axis=0) / count.sum()
        return summed

    centre = mean([one["mean"] for one in episodes])
    spread = mean([one["std"] ** 2 + (one["mean"] - centre) ** 2 for one in episodes])
    found = {
        "min": np.min([one["min"] for one in episodes], axis=0),
        "max": np.max([one["max"] for one in episodes], axis=0),
        "mean": centre,
        "std": np.sqrt(spread),
        "count": count.sum(axis=0),
        **{name: mean([one[name] for one in episodes]) for name in _QUANTILES},
    }
    return {name: values.tolist() for name, values in found.items()}
