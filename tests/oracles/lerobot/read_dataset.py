"""Reads a dataset with lerobot, and writes its columns and the statistics that lerobot finds: FOLDER OUT.npz."""

import sys
from pathlib import Path

import numpy as np
from lerobot.datasets.compute_stats import aggregate_stats, compute_episode_stats
from lerobot.datasets.dataset_metadata import LeRobotDatasetMetadata
from lerobot.datasets.feature_utils import get_hf_features_from_features
from lerobot.datasets.io_utils import load_nested_dataset

folder, out = map(Path, sys.argv[1:])
meta = LeRobotDatasetMetadata("me/waves", root=folder)
features = get_hf_features_from_features(meta.features)
rows = load_nested_dataset(folder / "data", features=features).with_format("numpy")
columns = {key: np.stack(list(rows[key])) for key in features}
begins = [(one["dataset_from_index"], one["dataset_to_index"]) for one in meta.episodes]
episodes = [
    compute_episode_stats({key: values[begin:end] for key, values in columns.items()}, meta.features)
    for begin, end in begins
]
found = {
    f"{kind}/{key}/{name}": value
    for kind, stats in (("stored", meta.stats), ("found", aggregate_stats(episodes)))
    for key, of in stats.items()
    for name, value in of.items()
}
tasks = [meta.tasks.iloc[index].name for index in columns["task_index"]]
np.savez(out, **columns, **found, begins=begins, tasks=tasks, names=meta.names["observation.state"])
