// Prints what @mcap/core finds in an MCAP file as one object of JSON: topics, schemas, times, samples and metadata.

const fs = require("node:fs/promises");
const fzstd = require("fzstd");
const protobuf = require("protobufjs");
require("protobufjs/ext/descriptor");
const { McapIndexedReader } = require("@mcap/core");

async function main(path) {
  const handle = await fs.open(path, "r");
  const readable = {
    size: async () => BigInt((await handle.stat()).size),
    read: async (offset, length) => {
      const data = new Uint8Array(Number(length));
      await handle.read(data, 0, Number(length), Number(offset));
      return data;
    },
  };
  const reader = await McapIndexedReader.Initialize({
    readable,
    decompressHandlers: { zstd: (data, size) => fzstd.decompress(data, new Uint8Array(Number(size))) },
  });
  const types = new Map();
  for (const schema of reader.schemasById.values()) {
    const set = protobuf.Root.fromDescriptor(require("protobufjs/ext/descriptor").FileDescriptorSet.decode(schema.data));
    types.set(schema.id, set.lookupType(schema.name));
  }
  const found = { topics: [], schemas: [], times: [], samples: [], metadata: {} };
  found.topics = [...reader.channelsById.values()].map((channel) => channel.topic);
  found.schemas = [...reader.schemasById.values()].map((schema) => schema.name);
  for await (const message of reader.readMessages()) {
    const type = types.get(reader.channelsById.get(message.channelId).schemaId);
    found.times.push(String(message.logTime));
    found.samples.push(type.toObject(type.decode(message.data), { enums: String, defaults: true }));
  }
  for await (const one of reader.readMetadata()) {
    found.metadata[one.name] = Object.fromEntries(one.metadata);
  }
  process.stdout.write(JSON.stringify(found));
}

main(process.argv[2]);
