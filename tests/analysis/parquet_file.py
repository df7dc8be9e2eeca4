"""A reader of the Parquet files that rodsweep.writing.parquet writes, from the format's description: for its tests."""

import gzip

import numpy as np

STORED = {1: "<i4", 2: "<i8", 4: "<f4", 5: "<f8"}
TEXT = 6


class Thrift:
    """Structures of the compact protocol as {field number: value}."""

    def __init__(self, data, at=0):
        self.data, self.at = data, at

    def byte(self):
        self.at += 1
        return self.data[self.at - 1]

    def varint(self):
        value, shift = 0, 0
        while True:
            byte = self.byte()
            value |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                return value

    def struct(self):
        fields, number = {}, 0
        while (head := self.byte()) != 0:
            number += head >> 4
            assert head >> 4, "fields far apart are not expected"
            fields[number] = self.value(head & 0xF)
        return fields

    def value(self, kind):
        if kind in (1, 2):
            return kind == 1
        if kind == 3:
            return self.byte()
        if kind in (5, 6):
            value = self.varint()
            return value >> 1 ^ -(value & 1)
        if kind == 8:
            length = self.varint()
            self.at += length
            return self.data[self.at - length:self.at].decode()
        if kind == 9:
            head = self.byte()
            count = head >> 4 if head >> 4 < 15 else self.varint()
            return [self.value(head & 0xF) for _ in range(count)]
        assert kind == 12, kind
        return self.struct()


class ParquetFile:
    """columns: {name: list with None for null}; schema: {name: SchemaElement}; metadata: {key: value}; groups: rows of
    each; dictionaries: names of columns with one."""

    def __init__(self, path):
        with open(path, "rb") as file:
            self.data = file.read()
        assert self.data[:4] == self.data[-4:] == b"PAR1"
        length = int.from_bytes(self.data[-8:-4], "little")
        footer = Thrift(self.data, len(self.data) - 8 - length)
        whole = footer.struct()
        assert footer.at == len(self.data) - 8, "the footer is as long as it says"
        root, *elements = whole[2]
        assert root[5] == len(elements)
        self.schema = {element[4]: element for element in elements}
        self.metadata = {pair[1]: pair[2] for pair in whole[5]}
        self.columns, self.dictionaries = {name: [] for name in self.schema}, set()
        groups, at = whole.get(4, []), 4
        for group in groups:
            for chunk, name in zip(group[1], self.schema):
                meta = chunk[3]
                assert meta[3] == [name] and meta[4] == 2 and chunk[2] == at and meta[5] == group[3]
                values, after = self._chunk(name, meta)
                assert after - at == meta[7]
                self.columns[name] += values
                at = after
            assert group[2] == sum(chunk[3][7] for chunk in group[1])
        assert at == len(self.data) - 8 - length, "there is nothing between the pages"
        self.groups = [group[3] for group in groups]
        assert whole[3] == sum(self.groups)

    def _page(self, at):
        header = Thrift(self.data, at)
        fields = header.struct()
        end = header.at + fields[3]
        body = gzip.decompress(self.data[header.at:end])
        assert len(body) == fields[2]
        return fields, body, end

    def _chunk(self, name, meta):
        dictionary, at = None, meta.get(11, meta[9])
        if 11 in meta:
            self.dictionaries.add(name)
            fields, body, at = self._page(at)
            assert fields[1] == 2
            dictionary = self._plain(meta[1], body, fields[7][1])
        assert at == meta[9]
        fields, body, at = self._page(at)
        count, length = fields[5][1], int.from_bytes(body[:4], "little")
        there = hybrid(body[4:4 + length], 1, count).astype(bool)
        body = body[4 + length:]
        if dictionary is None:
            found = self._plain(meta[1], body, there.sum())
        else:
            found = [dictionary[code] for code in hybrid(body[1:], body[0], there.sum())]
        values = iter(found)
        return [next(values) if one else None for one in there], at

    def _plain(self, physical, body, count):
        if physical != TEXT:
            return np.frombuffer(body, dtype=STORED[physical], count=count).tolist()
        texts, at = [], 0
        for _ in range(count):
            length = int.from_bytes(body[at:at + 4], "little")
            texts.append(body[at + 4:at + 4 + length].decode())
            at += 4 + length
        return texts


def hybrid(data, width, count):
    """Runs of the encoding RLE."""
    found, reader = [], Thrift(data)
    while len(found) < count:
        head = reader.varint()
        if head & 1:
            size = (head >> 1) * width
            bits = np.unpackbits(np.frombuffer(data, np.uint8, size, reader.at), bitorder="little").reshape(-1, width)
            found += (bits.astype(np.int64) << np.arange(width)).sum(axis=1).tolist()
            reader.at += size
        else:
            size = -(-width // 8)
            found += [int.from_bytes(data[reader.at:reader.at + size], "little")] * (head >> 1)
            reader.at += size
    return np.array(found[:count], dtype=np.int64)
