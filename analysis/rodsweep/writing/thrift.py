"""Structures in Thrift's compact protocol, as Parquet's headers and footer are written.

A structure is a list of fields (number, kind, value) in rising order of their numbers, those of value None left out; a
kind is one of KINDS or a list of one, such as ["struct"].
https://github.com/apache/thrift/blob/master/doc/specs/thrift-compact-protocol.md
"""

KINDS = {"bool": 1, "i8": 3, "i32": 5, "i64": 6, "text": 8, "list": 9, "struct": 12}
FALSE = 2


def struct(fields):
    out, last = bytearray(), 0
    for number, kind, value in fields:
        if value is None:
            continue
        code = KINDS["list" if isinstance(kind, list) else kind]
        if kind == "bool" and not value:
            code = FALSE
        out.append((number - last) << 4 | code)    # numbers are less than 15 apart in Parquet
        if kind != "bool":
            out += _value(kind, value)
        last = number
    return bytes(out) + b"\0"


def varint(value):
    out = bytearray()
    while value > 0x7F:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes(out) + bytes([value])


def _value(kind, value):
    if isinstance(kind, list):
        head = bytes([len(value) << 4 | KINDS[kind[0]]]) if len(value) < 15 else \
            bytes([0xF0 | KINDS[kind[0]]]) + varint(len(value))
        return head + b"".join(_value(kind[0], item) for item in value)
    if kind == "struct":
        return struct(value)
    if kind == "text":
        data = value.encode()
        return varint(len(data)) + data
    if kind == "i8":
        return bytes([value])
    return varint(value << 1 if value >= 0 else (-value << 1) - 1)
