"""Reading and writing files, whatever they hold: whole or not at all, TOML against a schema, CSV by columns."""
