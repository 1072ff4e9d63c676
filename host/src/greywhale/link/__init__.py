"""The serial link to the board: messages, parameters, frames."""
