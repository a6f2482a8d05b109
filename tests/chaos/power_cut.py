"""The model of a power cut: a folder as it may be found after one.

POSIX promises little. Bytes that were written after the last fsync() of a file may be lost. Names that were made,
changed or removed in a folder after its last fsync() may be lost too. faults.cpp files what was synced.
Not modelled: a folder with a part of its changes, and sectors that are written in part.
"""

import dataclasses
import shutil

PAGE = 4096


@dataclasses.dataclass
class State:
    """All that is below a folder, by device and inode."""

    folders: dict  # {name: key of a folder or a file}
    files: dict  # bytes
    modes: dict


def key(path):
    status = path.lstat()
    return f"{status.st_dev}-{status.st_ino}"


def look(root):
    state = State({}, {}, {})
    for path in [root, *root.rglob("*")]:
        if path.is_dir():
            state.folders[key(path)] = {child.name: key(child) for child in path.iterdir()}
        else:
            state.files[key(path)], state.modes[key(path)] = path.read_bytes(), path.lstat().st_mode
    return state


def add_synced(state, records):
    for record in records.glob("f*-*"):  # not one whose fsync() was interrupted
        kind, number = record.name.split("-", 1)
        if kind == "file":
            state.files[number] = record.read_bytes()
        else:
            device = number.partition("-")[0]
            entries = [line.split("\t", 1) for line in record.read_text().splitlines()]
            state.folders[number] = {name: f"{device}-{inode}" for inode, name in entries if name not in (".", "..")}


def cut(records, root, earlier, chance):
    """Bring the folder `root` into a state after a power cut. `earlier` is its state before, which is synced."""
    now, synced = look(root), earlier
    add_synced(synced, records)
    keeps_names = chance.choice([True, False, None])  # None: those of some folders

    def names_of(folder):
        keeps = chance.random() < 0.5 if keeps_names is None else keeps_names
        first, second = (now, synced) if keeps else (synced, now if folder not in now.folders else synced)
        return first.folders.get(folder, second.folders.get(folder, {}))

    def bytes_of(file):
        kept, written = synced.files.get(file, b""), now.files.get(file)
        if written is None or chance.random() < 0.6:
            return kept
        if len(kept) == len(written):  # in place, page by page
            return b"".join(chance.choice((kept, written))[at:at + PAGE] for at in range(0, len(kept), PAGE))
        return written[:chance.randint(min(len(kept), len(written)), len(written))]

    def make(folder, path):
        for name, child in sorted(names_of(folder).items()):
            if child in now.folders or child in synced.folders:
                (path / name).mkdir()
                make(child, path / name)
            else:
                (path / name).write_bytes(bytes_of(child))
                (path / name).chmod(now.modes.get(child, synced.modes.get(child, 0o644)))

    top = key(root)
    for path in root.iterdir():
        shutil.rmtree(path) if path.is_dir() else path.unlink()
    make(top, root)
