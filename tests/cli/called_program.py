"""Our binaries, called as a user would: through pipes, or on a terminal of some width."""

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

FAILS = ["--set", "fault.sensor=q1", "fault.at_s=0.3"]  # an arm's run of half a second


def environment(**changes):
    """This one but for the changes; None takes a variable away."""
    changed = {**os.environ, "TERM": "xterm", "NO_COLOR": None, "COLUMNS": None, **changes}
    return {key: str(value) for key, value in changed.items() if value is not None}


class Folder(unittest.TestCase):
    """Tests in a folder of their own."""

    def setUp(self):
        held = tempfile.TemporaryDirectory()
        self.addCleanup(held.cleanup)
        self.folder = pathlib.Path(held.name)

    def call(self, *words, status=0, **changes):
        """stdout and stderr of `words`, the first of which names a binary."""
        done = subprocess.run([BIN / words[0], *words[1:]], cwd=self.folder, text=True,
                              capture_output=True, env=environment(**changes))
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout, done.stderr

    def on_terminal(self, *words, columns=80, **changes):
        """All that it writes on a terminal."""
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
            except OSError as error:  # how Linux says that the other end is closed
                if error.errno != errno.EIO:
                    raise
                part = b""
            if not part:
                break
            seen += part
        os.close(leader)
        process.wait()
        return seen.decode()

    def push(self, name, *more, status=0):
        """Half a second of arm_push in folder `name`."""
        return self.call("arm_push", "--quiet", "--duration", "0.5", "--out", name, *more,
                         status=status)
