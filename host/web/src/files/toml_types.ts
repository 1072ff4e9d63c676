// Types of the things that a TOML file can hold, and of their places in it.

export type Toml = string | number | bigint | boolean | Date | readonly Toml[] | TomlTable;
export type TomlTable = { readonly [key: string]: Toml };
export type Path = readonly (string | number)[];
