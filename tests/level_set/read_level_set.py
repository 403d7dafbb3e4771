"""Prints what Debian's OpenVDB module for Python finds in a level set: its name, class and background, and the
distances at the points given as x y z on the command line, by linear interpolation. Ends with 77 where there is no
such module."""
import sys

try:
    import pyopenvdb as vdb
except ImportError:
    sys.exit(77)

grid = vdb.readAllGridMetadata(sys.argv[1])[0]
grid = vdb.read(sys.argv[1], grid.name)
print(grid.name, grid.gridClass.replace(" ", "_"), grid.background)
accessor = grid.getConstAccessor()
numbers = [float(word) for word in sys.argv[2:]]
for k in range(0, len(numbers), 3):
    at = grid.transform.worldToIndex(tuple(numbers[k : k + 3]))
    low = [int(c // 1) for c in at]
    value = 0.0
    for corner in range(8):
        offset = [corner >> 2 & 1, corner >> 1 & 1, corner & 1]
        weight = 1.0
        for axis in range(3):
            t = at[axis] - low[axis]
            weight *= t if offset[axis] else 1 - t
        value += weight * accessor.getValue(tuple(l + o for l, o in zip(low, offset)))
    print(value)
