"""What a viewer such as Foxglove needs of a recording, looked for with the reference reader of MCAP: prints what is missing, a line each.

    viewer.py FILE.mcap
"""

import re
import sys

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

BUILT_IN = {
    "bool", "byte", "char", "float32", "float64", "string", "wstring",
    "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64",
}


def complaints(path):
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()], validate_crcs=True)
        header, summary = reader.get_header(), reader.get_summary()
        if header.profile != "ros2":
            yield f"the profile is {header.profile!r}"
        if summary is None or summary.statistics is None:
            yield "there is no summary, or no statistics in it"
            return
        yield from of_index(summary)
        for schema in summary.schemas.values():
            yield from of_schema(schema)
        for channel in summary.channels.values():
            if channel.message_encoding != "cdr" or not channel.topic.startswith("/"):
                yield f"{channel.topic!r} is encoded as {channel.message_encoding}"
        counts, last = {}, 0
        for _, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
            counts[channel.id] = counts.get(channel.id, 0) + 1
            if decoded is None:
                yield f"a message of {channel.topic} cannot be decoded"
            last = max(last, message.log_time)
        if counts != summary.statistics.channel_message_counts:
            yield f"the statistics count {summary.statistics.channel_message_counts}, there are {counts}"
        if last != summary.statistics.message_end_time:
            yield f"the statistics end at {summary.statistics.message_end_time}, the messages at {last}"


def of_index(summary):
    """A viewer jumps to a time: every chunk is indexed, and in it the messages of every channel."""
    if not summary.chunk_indexes or len(summary.chunk_indexes) != summary.statistics.chunk_count:
        yield f"{len(summary.chunk_indexes)} of {summary.statistics.chunk_count} chunks are indexed"
    for chunk in summary.chunk_indexes:
        if not chunk.message_index_offsets:
            yield f"the chunk at {chunk.chunk_start_offset} has no index of its messages"
        if chunk.compression not in ("", "lz4", "zstd"):
            yield f"a chunk is compressed by {chunk.compression!r}"


def of_schema(schema):
    """The name as ROS 2 spells it, and the definition with those of all messages in it."""
    if schema.encoding != "ros2msg" or not re.fullmatch(r"\w+/msg/\w+", schema.name):
        yield f"schema {schema.name!r} is of {schema.encoding!r}"
    texts = re.split(r"^=+\n", schema.data.decode(), flags=re.MULTILINE)
    known = {re.match(r"MSG: (\S+)\n", text).group(1) for text in texts[1:]}
    for text in texts:
        package = schema.name.split("/")[0]
        if named := re.match(r"MSG: (\S+)\n", text):
            package, text = named.group(1).split("/")[0], text[named.end():]
        for line in text.splitlines():
            field = line.split("#")[0].split()
            if len(field) < 2 or "=" in field[1] or (len(field) > 2 and field[2].startswith("=")):
                continue
            base = re.sub(r"(<=\d+)?(\[.*\])?$", "", field[0])
            full = base if "/" in base else f"{package}/{base}"
            if base not in BUILT_IN and full not in known:
                yield f"{schema.name} has a field of {full}, which is not defined"


for complaint in complaints(sys.argv[1]):
    print(complaint)
