// Opens a recording with the libraries that Foxglove opens it with, and decodes every message: prints for each topic its type, how many messages
// there are, and how many after a jump to the middle.
//
//     node foxglove.mjs FILE.mcap

import { open } from "node:fs/promises";
import { createRequire } from "node:module";

const require = createRequire(new URL("../../../../.foxglove/", import.meta.url));
const { McapIndexedReader } = require("@mcap/core");
const { FileHandleReadable } = require("@mcap/nodejs");
const { loadDecompressHandlers } = require("@mcap/support");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");

/** What decodes the messages of a channel. */
function decoder({ topic, messageEncoding }, schema) {
  const text = new TextDecoder();
  switch (`${messageEncoding} of ${schema?.encoding}`) {
    case "cdr of ros2msg": {
      const messages = new MessageReader(parse(text.decode(schema.data), { ros2: true }));
      return (bytes) => messages.readMessage(bytes);
    }
    case "json of jsonschema":
      JSON.parse(text.decode(schema.data));
      return (bytes) => JSON.parse(text.decode(bytes));
    default:
      throw new Error(`${topic} is ${messageEncoding} of ${schema?.encoding}`);
  }
}

const file = await open(process.argv[2]);
const readable = new FileHandleReadable(file);
const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers: await loadDecompressHandlers() });

const channels = new Map();
for (const [id, channel] of reader.channelsById) {
  const schema = reader.schemasById.get(channel.schemaId);
  channels.set(id, { topic: channel.topic, type: schema?.name, decode: decoder(channel, schema), all: 0, late: 0 });
}

const { messageStartTime, messageEndTime, channelMessageCounts } = reader.statistics;
const middle = (messageStartTime + messageEndTime) / 2n;
for await (const message of reader.readMessages()) {
  const channel = channels.get(message.channelId);
  channel.decode(message.data);
  channel.all += 1;
}
for await (const message of reader.readMessages({ startTime: middle })) {
  if (message.logTime < middle) {
    throw new Error(`a message at ${message.logTime} comes after a jump to ${middle}`);
  }
  channels.get(message.channelId).late += 1;
}
for (const [id, { topic, type, all, late }] of channels) {
  if (BigInt(all) !== (channelMessageCounts.get(id) ?? 0n)) {
    throw new Error(`${topic} has ${all} messages, and ${channelMessageCounts.get(id)} by the statistics`);
  }
  console.log(topic, type, all, late);
}
await file.close();
