"""Files people write: TOML tables and leader recordings, checked before anything else looks at them."""
