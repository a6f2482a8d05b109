"""The model of a power cut: a folder as it may be found after one.

POSIX promises little. Bytes that were written after the last fsync() of a file may be lost. Names that were
made, changed or removed in a folder after its last fsync() may be lost too, from some moment on.
Not modelled: bytes that are overwritten in place, and sectors that are written in part.
"""

import dataclasses
import os
import pathlib
import shutil


@dataclasses.dataclass
class Change:
    """A change of names in one or two folders."""

    kind: str  # +f +d -f -d: file or folder, made or removed. >: renamed, x: exchanged, &: linked
    folders: list  # inodes
    names: list
    inode: int  # the file or folder that gets or loses a name
    grave: str  # another name for the file that lost its name; "0" without one
    unsynced: set  # inodes of the folders that are not synced since


def read_journal(file):
    """(changes of names, [synced bytes, whether more were written] of each inode)."""
    changes, bytes_of = [], {}
    for line in file.read_text().splitlines():
        what, *rest = line.split("\t")
        if what in "WTS":
            inode, size = int(rest[0]), int(rest[1])
            if what == "S":
                bytes_of[inode] = [size, False]
                for change in changes:
                    change.unsynced.discard(inode)
            else:
                synced = bytes_of.get(inode, [0])[0] if what == "W" else 0
                bytes_of[inode] = [synced, True]
            continue
        count = 2 if what in (">", "x", "&") else 1
        folders = [int(word) for word in rest[:count]]
        changes.append(Change(what, folders, [pathlib.Path(path).name for path in rest[-count:]],
                              int(rest[count]), rest[count + 1], set(folders)))
    return changes, bytes_of


def lose_bytes(roots, bytes_of, chance):
    for root in roots:
        for path in root.rglob("*"):
            status = path.lstat()
            synced, is_written = bytes_of.get(status.st_ino, (0, False))
            if path.is_symlink() or not path.is_file() or not is_written or status.st_size <= synced:
                continue
            os.truncate(path, synced if chance.random() < 0.6 else chance.randint(synced, status.st_size))


class Undo:
    """Takes back changes of names, the last one first."""

    def __init__(self, root, graves):
        self.root, self.graves = root, graves
        self.made = {}  # folders that are made again, by their former inode

    def folder(self, inode):
        if inode in self.made:
            return self.made[inode]
        for path in [self.root, *self.root.rglob("*")]:
            if path.is_dir() and not path.is_symlink() and path.stat().st_ino == inode:
                return path
        return None

    def revive(self, grave, path):
        if grave != "0" and not path.exists():
            os.link(self.graves / grave, path)

    def take_back(self, change):
        folders = [self.folder(inode) for inode in change.folders]
        if None in folders:
            return  # not below the root, or lost with its folder
        paths = [folder / name for folder, name in zip(folders, change.names)]
        path = paths[-1]
        is_there = os.path.lexists(path)
        if change.kind == "+f" and is_there and not path.is_dir():
            path.unlink()
        elif change.kind == "+d" and path.is_dir():
            shutil.rmtree(path)
        elif change.kind == "-f":
            self.revive(change.grave, path)
        elif change.kind == "-d" and not is_there:
            path.mkdir()
            self.made[change.inode] = path
        elif change.kind in (">", "x", "&") and is_there and path.lstat().st_ino == change.inode:
            # Otherwise the process ended before the call.
            if change.kind == "&":
                path.unlink()
            elif change.kind == ">":
                path.rename(paths[0])
                self.revive(change.grave, path)
            else:
                between = path.with_name(".exchanged")
                path.rename(between)
                paths[0].rename(path)
                between.rename(paths[0])


def cut(journal, root, graves, chance):
    """Bring the folder `root` into a state after a power cut."""
    if not journal.exists():
        return
    changes, bytes_of = read_journal(journal)
    lose_bytes([root, graves], bytes_of, chance)
    kept = chance.choice([0, len(changes), chance.randint(0, len(changes))])
    undo = Undo(root, graves)
    for change in reversed(changes[kept:]):
        if change.unsynced:
            undo.take_back(change)
