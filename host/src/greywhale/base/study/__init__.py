"""Repeated studies (seeds, arms, methods) in processes here, on a Dask scheduler's workers, and after a kill.

    tasks = [Task(f"arm {n}", judge_arm, seed=n, arguments={"budget": 500}) for n in range(10)]
    found = run_study(tasks, choose_workers(), results=Path("arms.study"), what="judging arms")
    found["arm 3"]          # what judge_arm(seed=3, budget=500) returned

- A `Task` is a function of a module, called as `function(seed=seed, **arguments)`. Arguments and what it returns are
  plain: None, bool, int, float, str, numpy arrays, and lists, tuples or dicts (with keys of str) of these; a tuple
  comes back as a list. All random numbers of a task follow from its seed and arguments.
- `run_study(tasks, executor, results=None, progress=None, about=None, what="working")` returns {key: result} in the
  order of the tasks, whatever the order in which they end, the same bit for bit on every executor and after every
  resumption. `executor` is any `concurrent.futures.Executor`, or workers:

      SerialWorkers()                         this process, one task after another
      LocalWorkers(4)                         four processes here
      ClusterWorkers("tls://10.0.0.5:8786")   the workers of a Dask scheduler
      choose_workers(count, scheduler)        what --workers and --scheduler of a verb say: one of these

- `results` is a file with a checked line for every task that is done. A study that finds its file does only what is
  missing. The file belongs to the version of greywhale, the tasks and `about` (what the study is about, for people:
  a difference is named by its key); another study's file is refused with a UserError.
- `progress(what, share)` is told after every task.
- A process here that ends before its task is done ends the study with a UserError; the task of a lost worker of a
  scheduler is done again by another one.
- A worker with other versions of greywhale, Python, numpy or scipy, or on a machine that rounds otherwise, refuses.
- A function that answers Ctrl-C itself, as `identify` and `tune` do, must raise KeyboardInterrupt where what they gave
  back is not `complete`: half a result is none.
- A UserError of a task ends the study; so does any other error, as `TaskFailed` with the worker's traceback. Ctrl-C
  ends it too, at once. What is done stays in the file.
"""

from greywhale.base.study.cluster import ClusterWorkers
from greywhale.base.study.run import run_study
from greywhale.base.study.task import Task, TaskFailed
from greywhale.base.study.workers import LocalWorkers, SerialWorkers, Workers, choose_workers, left_at_once

__all__ = [
    "ClusterWorkers",
    "LocalWorkers",
    "SerialWorkers",
    "Task",
    "TaskFailed",
    "Workers",
    "choose_workers",
    "left_at_once",
    "run_study",
]
