"""`doctor`: optional parts can be missing, necessary parts can be broken.

Usage: doctor_test.py BIN_FOLDER
"""

import json
import shutil
import unittest

from called_program import BIN, Folder

CHECKS = ["runs", "pictures", "video", "font", "pages"]


class Doctor(Folder):
    def doctor(self, status=0, **changes):
        checks = json.loads(self.call("breakwater", "doctor", "--json", status=status, **changes)[0])
        self.assertEqual([check["what"] for check in checks], CHECKS)
        return {check["what"]: check for check in checks}

    def hide(self, *libraries):
        """Return a folder that hides libraries if it is LD_LIBRARY_PATH."""
        for library in libraries:
            (self.folder / library).write_text("no library")
        return {"LD_LIBRARY_PATH": self.folder}

    def test_says_in_80_columns_what_works(self):
        out, err = self.call("breakwater", "doctor")
        self.assertEqual(err, "")
        for name in CHECKS:
            self.assertIn("\n" + name, "\n" + out)
        for line in out.splitlines():
            self.assertLessEqual(len(line), 80, line)
        checks = self.doctor()
        for name in ("runs", "video", "font", "pages"):
            self.assertEqual(checks[name]["state"], "ok", checks[name])

    def test_what_is_optional_may_be_missing(self):
        hidden = self.hide("libEGL.so.1")
        checks = self.doctor(**hidden)
        self.assertEqual(checks["pictures"]["state"], "missing")
        self.assertIn("libgl1-mesa-dri", checks["pictures"]["install"])
        out, _ = self.call("breakwater", "doctor", **hidden)
        self.assertIn("> apt install libegl1 libgl1-mesa-dri", out)

    def test_an_opengl_that_is_there_and_does_not_draw_is_broken(self):
        pictures = self.doctor(status=1, __EGL_VENDOR_LIBRARY_DIRS=self.folder)["pictures"]
        self.assertEqual(pictures["state"], "broken")
        self.assertIn("EGL", pictures["found"])

    def test_nonsense_in_the_environment_is_broken(self):
        pictures = self.doctor(status=1, MUJOCO_GL="softpipe")["pictures"]
        self.assertIn('MUJOCO_GL: "softpipe"', pictures["found"])

        checks = self.doctor(status=1, MUJOCO_EGL_DEVICE_ID="abc")
        self.assertEqual(checks["pictures"]["state"], "broken")

    def test_models_that_cannot_be_read_are_broken(self):
        source = BIN.resolve().parents[1]
        shutil.copytree(source / "models", self.folder / "models")
        (self.folder / "models/arm.xml").write_text("<mujoco>")
        runs = self.doctor(status=1, BREAKWATER_PATH=self.folder)["runs"]
        self.assertEqual(runs["state"], "broken")
        self.assertIn("arm.xml", runs["found"])
        out, _ = self.call("breakwater", "doctor", status=1, BREAKWATER_PATH=self.folder)
        self.assertTrue(out.endswith("1 of 5 broken\n"), out)


if __name__ == "__main__":
    unittest.main()
