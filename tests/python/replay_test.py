"""The output of a run in a notebook: its replay in Chromium, or its metrics and the reason."""

import pathlib
import shutil
import sys
import tempfile
import unittest
from unittest import mock

import breakwater as bw
from breakwater import runs
from support import temporary_folder

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from chromium import visit  # noqa: E402

# A page with the cell's output, like a notebook. It reports the drawings of its frame at two times.
NOTEBOOK = """<!doctype html><body>%s<script>
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
(async () => {
  const seen = {pictures: []};
  try {
    const box = () => document.querySelector("iframe").contentDocument.querySelector(".replay");
    while (!["ready", "failed"].includes(box()?.dataset.state)) await wait(50);
    seen.state = box()?.dataset.state;
    const view = box().replay;
    for (const time of [0.05, 2.9]) {
      view.seek(time);
      view.draw(true);
      seen.pictures.push(view.canvas.toDataURL("image/png"));
    }
  } catch (error) { seen.error = String(error); }
  await fetch("/", {method: "POST", body: JSON.stringify(seen)});
})();
</script>"""


class InANotebook(unittest.TestCase):
    def test_a_run_that_was_not_saved_is_its_replay(self):
        run = bw.run("motor_estimation", case="stf", duration=3)
        with temporary_folder() as folder:
            before, tempfile.tempdir = tempfile.tempdir, str(folder)
            try:
                shown = run._repr_html_()
            finally:
                tempfile.tempdir = before
            self.assertEqual(list(folder.iterdir()), [])
            self.assertIsNone(run.folder)
            self.assertLess(len(shown), 600_000)
            page = (NOTEBOOK % shown).encode()
            seen, _, asked = visit({"/": (page, "text/html; charset=utf-8")}, folder, [
                "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist",
                "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"])
        self.assertEqual((seen.get("error"), seen.get("state")), (None, "ready"))
        first, last = seen["pictures"]
        self.assertGreater(len(first), 2000)
        self.assertNotEqual(first, last)  # the motor has turned
        self.assertEqual([path for path in asked if path not in ("/", "/favicon.ico")], [])

    def test_a_saved_run_is_shown_without_writing_into_its_folder(self):
        with temporary_folder() as folder:
            run = bw.run("arm_push", case="drac-link1", duration=0.2, out=folder / "run")
            files = sorted((folder / "run").iterdir())
            shown = bw.load(folder / "run")._repr_html_()
            self.assertTrue(shown.startswith("<iframe srcdoc="))
            self.assertEqual(shown, run._repr_html_())
            self.assertEqual(sorted((folder / "run").iterdir()), files)
            self.assertEqual(run.replay(), folder / "run" / "replay.html")
            self.assertIn("arm_push", (folder / "run" / "replay.html").read_text())

    def test_is_of_this_run_whatever_its_folder_holds_by_now(self):
        with temporary_folder() as folder:
            first = bw.run("motor_estimation", case="stf", duration=1, out=folder / "run")
            shown = first._repr_html_()
            bw.run("motor_estimation", case="idob", duration=1, out=folder / "run")
            self.assertEqual(first._repr_html_(), shown)
            shutil.rmtree(folder / "run")
            self.assertEqual(first._repr_html_(), shown)

    def test_a_run_that_was_replayed_is_made_again(self):
        with temporary_folder() as folder:
            for case in ("stf", "idob"):
                run = bw.run("motor_estimation", case=case, duration=0.1, out=folder / "run")
                self.assertEqual(run.replay(), folder / "run" / "replay.html")

    def test_nothing_is_written_into_the_folder_of_another_run(self):
        first = dict(case="stf", duration=0.1)
        with temporary_folder() as folder:
            own = bw.run("motor_estimation", **first, out=folder / "run")
            saved = bw.load(folder / "run")
            bw.run("motor_estimation", case="idob", duration=0.1, out=folder / "run")
            files = sorted((folder / "run").iterdir())
            for make in (own.replay, own.video):
                with self.assertRaisesRegex(bw.InputError, "^file: must be given: there is another run in .*/run$"):
                    make()
            for make in (saved.replay, saved.video, lambda: saved.replay(folder / "page.html"),
                         lambda: saved.save(folder / "copy")):
                self.assertRaisesRegex(bw.InputError, "there is another run in .*/run$", make)
            self.assertIn("there is another run in", saved._repr_html_())
            self.assertEqual(sorted((folder / "run").iterdir()), files)
            self.assertEqual([path.name for path in folder.iterdir()], ["run"])
            self.assertGreater(own.replay(folder / "page.html").stat().st_size, 1000)
            shutil.rmtree(folder / "run")
            for run in (own, saved):
                self.assertRaisesRegex(bw.InputError, "there is no such folder", run.replay)
            bw.run("motor_estimation", **first, out=folder / "run")  # the folder has the run again
            self.assertEqual(own.replay(), saved.replay())

    def test_without_a_replay_it_is_a_table_that_says_why(self):
        run = bw.run("motor_estimation", case="stf", duration=12)
        self.assertGreater(len(run.metrics), 5)
        with mock.patch.object(runs, "_LARGEST_FRAME", 1000):
            large = run._repr_html_()
        with temporary_folder() as folder:
            saved = bw.load(run.save(folder / "run"))
            (folder / "run" / "log.h5").unlink()
            self.assertRaisesRegex(bw.InputError, "replay: .*log.h5", saved.replay, folder / "page.html")
            broken = saved._repr_html_()
        for shown, why in ((large, "too much for a notebook"), (broken, "log.h5")):
            self.assertIn(why, shown)
            self.assertIn("<table>", shown)
            self.assertIn(run.state_hash, shown)
            for name in run.metrics:
                self.assertIn(f"<td>{name}</td><td>{run.metrics[name]:.6g}</td>", shown)
            self.assertNotIn("<iframe", shown)
        self.assertRaisesRegex(bw.InputError, "camera", run.replay, "unused.html", camera="nowhere")
        with self.assertRaisesRegex(bw.InputError, "file: must be given"):
            bw.run("arm_push", duration=0.05).replay()


if __name__ == "__main__":
    unittest.main()
