"""The words of a page's forms: the groups of verbs in the order of use, and a label for each argument.

A form shows the arguments in `first` at once; the others stand under "More". A file's argument takes these kinds of
`dashboard.folder.FileFacts` from the folder; without a kind it names a new file, or a folder.
"""

from __future__ import annotations

from typing import NamedTuple


class FormWords(NamedTuple):
    """A verb as a person would ask for it, and the arguments that matter first."""

    title: str
    first: tuple[str, ...] = ()


class Words(NamedTuple):
    """The label of an argument, the unit of its number, and the kinds of file that it takes."""

    label: str
    unit: str = ""
    kinds: tuple[str, ...] = ()


GROUPS: dict[str, dict[str, FormWords]] = {
    "Real arm": {
        "flash": FormWords("Flash the firmware"),
        "doctor": FormWords("Check board and set-up", ("supply",)),
        "arm new": FormWords("Describe your arm", ("answers", "out")),
        "arm match": FormWords("Calibrated arm file", ("arm", "out")),
        "info": FormWords("Ask the board how it is"),
    },
    "Learn": {
        "commission": FormWords("Let the arm learn", ("arm_file", "out")),
        "record": FormWords("Record a log", ("seconds", "enable", "out")),
        "replay": FormWords("Lead along a motion", ("motion", "out")),
        "evaluate": FormWords("Measure a log", ("logs",)),
        "identify": FormWords("Find a model of the arm", ("logs", "arm_file", "out")),
        "tune": FormWords("Tune the controllers", ("model_file", "out")),
        "upload": FormWords("Upload controllers", ("controller",)),
        "adapt": FormWords("Adapt while you work", ("model", "seconds", "out")),
    },
    "Files": {
        "params backup": FormWords("Back up the parameters", ("file",)),
        "params diff": FormWords("Compare with a backup", ("file",)),
        "params restore": FormWords("Restore a backup", ("file",)),
    },
}

_ARM, _MODEL, _CONTROLLER, _PARAMETERS, _LOG = ("arm", "model"), ("model",), ("controller",), ("parameters",), ("log",)
# By the name of the argument, after the verb where the verb gives it words of its own.
WORDS: dict[str, Words] = {
    "out": Words("Name of the new file"),
    "overwrite": Words("Replace files that are there already"),
    "seed": Words("Seed of the random numbers"),
    "every": Words("Time from one sample to the next", "ms"),
    "workers": Words("Threads"),
    "ranges": Words("Ranges of joints", "rad"),
    "arm_file": Words("Arm file", "", _ARM),
    "logs": Words("Logs", "", _LOG),
    "method": Words("Method"),
    "pictures": Words("Folder for pictures"),
    "budget": Words("Controllers to try for each joint"),
    "record out": Words("Name of the log"),
    "record seconds": Words("Time to record", "s"),
    "record enable": Words("Turn the motors on"),
    "record disengaged": Words("Begin with the clutch disengaged"),
    "record excite": Words("Let greywhale lead the arm"),
    "record poses": Words("Visits of each pose from either side"),
    "record budget": Words("Motions to try"),
    "record save_motion": Words("Name of a file for the motion"),
    "replay motion": Words("Motion", "", ("motion", "log")),
    "replay out": Words("Name of the log"),
    "doctor params": Words("Parameters that the board should run", "", _PARAMETERS),
    "doctor seconds": Words("Time to load the link", "s"),
    "doctor supply": Words("Voltage that you measured at the motors' supply", "V"),
    "evaluate picture": Words("Name of a picture"),
    "evaluate model": Words("Model that tells what acts from outside", "", _MODEL),
    "evaluate repeatability": Words("Measure how exactly the arm came back to poses"),
    "identify validate": Words("Logs that only judge the model", "", _LOG),
    "identify controllers": Words("Controllers that the logs were recorded with", "", ("controller", "parameters")),
    "tune model_file": Words("Model", "", _ARM[::-1]),
    "tune strategy": Words("What is searched"),
    "tune start": Words("Controllers to begin with", "", _CONTROLLER),
    "tune bounds": Words("Narrower bounds"),
    "tune arm": Words("Arm that the model must be of", "", _ARM),
    "tune params": Words("Parameters of the board", "", _PARAMETERS),
    "tune samples": Words("Arms as likely as the model"),
    "tune quiet": Words("Quietness at rest"),
    "tune resume": Words("Go on where the last tuning ended"),
    "tune force": Words("Tune even if the model is in doubt"),
    "tune tables": Words("Show the paper's tables, too"),
    "commission out": Words("Folder for all files"),
    "commission model": Words("Model to begin with", "", _MODEL),
    "commission rounds": Words("Models to make at most"),
    "commission trials": Words("Sets to try in each round"),
    "commission resume": Words("Go on where the last commissioning ended"),
    "adapt model": Words("Model of this arm", "", _MODEL),
    "adapt seconds": Words("Time to work", "s"),
    "adapt budget": Words("Controllers to try in each search"),
    "adapt store": Words("Store what was kept without a question"),
    "upload controller": Words("Controllers", "", _CONTROLLER),
    "upload yes": Words("Store without a question, even where a joint may swing"),
    "arm new answers": Words("The arm"),
    "arm match arm": Words("Arm file", "", _ARM),
    "params backup file": Words("Name of the backup"),
    "params diff file": Words("Backup", "", _PARAMETERS),
    "params restore file": Words("Backup", "", _PARAMETERS),
    "params restore missing": Words("Parameters that the backup does not state"),
    "flash board": Words("Board"),
    "flash firmware": Words("Folder of firmware source"),
    "flash hex_file": Words("HEX file", "", ("firmware",)),
}


def words_of(verb: str, argument: str) -> Words:
    """The words of an argument of a verb."""
    return WORDS.get(f"{verb} {argument}") or WORDS[argument]
