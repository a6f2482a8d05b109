"""Calls our binaries like a user: through pipes, or on a terminal of some width."""

import errno
import fcntl
import os
import pathlib
import pty
import struct
import subprocess
import sys
import tempfile
import termios
import unittest

BIN = pathlib.Path(sys.argv.pop()).resolve() if len(sys.argv) > 1 else None


def environment(**changes):
    """The environment with changes; None removes a variable."""
    changed = {**os.environ, "TERM": "xterm", "COLUMNS": None, **changes}
    return {key: str(value) for key, value in changed.items() if value is not None}


class Folder(unittest.TestCase):
    """Tests in a temporary folder."""

    def setUp(self):
        held = tempfile.TemporaryDirectory()
        self.addCleanup(held.cleanup)
        self.folder = pathlib.Path(held.name)

    def call(self, *words, status=0, **changes):
        """Call a binary with arguments and return its stdout and stderr."""
        done = subprocess.run([BIN / words[0], *words[1:]], cwd=self.folder, text=True,
                              capture_output=True, env=environment(**changes))
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout, done.stderr

    def on_terminal(self, *words, columns=80, **changes):
        """The output of a command on a terminal."""
        leader, follower = pty.openpty()
        fcntl.ioctl(follower, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        process = subprocess.Popen([BIN / words[0], *words[1:]], cwd=self.folder,
                                   stdin=follower, stdout=follower, stderr=follower,
                                   env=environment(**changes))
        os.close(follower)
        seen = b""
        while True:
            try:
                part = os.read(leader, 4096)
            except OSError as error:  # the other end is closed
                if error.errno != errno.EIO:
                    raise
                part = b""
            if not part:
                break
            seen += part
        os.close(leader)
        process.wait()
        return seen.decode()
