"""A structured array whose columns are read by name."""

from masonry._given import shown


class Table:
    """`table`: the structured array; self["name"] is one of its columns, len(self) its rows."""

    def __getitem__(self, name):
        if name not in self.table.dtype.names:
            raise KeyError(f"{shown(name)}: must be one of {', '.join(self.table.dtype.names)}")
        return self.table[name]

    def __len__(self):
        return len(self.table)
