"""lerobot-record as its users call it, then `read_dataset.py`: PORT FOLDER OUT.npz."""

import runpy
import sys
from pathlib import Path

import lerobot.scripts.lerobot_record as recorder

port, folder, out = sys.argv[1:]
sys.argv = [
    "lerobot-record",
    *("--robot.type=greywhale", f"--robot.port={port}", "--teleop.type=greywhale_leader", f"--teleop.port={port}"),
    *("--dataset.repo_id=me/waves", f"--dataset.root={folder}", "--dataset.single_task=Wave", "--dataset.fps=30"),
    *("--dataset.num_episodes=2", "--dataset.episode_time_s=1.5", "--dataset.reset_time_s=0.2"),
    *("--dataset.push_to_hub=false", "--play_sounds=false"),
]
recorder.main()
sys.argv = ["read", folder, out]
runpy.run_path(str(Path(__file__).with_name("read_dataset.py")))
