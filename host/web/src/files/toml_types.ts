// What a TOML file can hold, and where in it something stands.

export type Toml = string | number | bigint | boolean | Date | readonly Toml[] | TomlTable;
export type TomlTable = { readonly [key: string]: Toml };
export type Path = readonly (string | number)[];
