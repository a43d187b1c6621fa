# SPDX-License-Identifier: GPL-2.0-or-later
"""Checkpoints: whole and on the disk before anything counts on them; damaged ones are left out."""

import contextlib
import io
import json
import os
import resource
import shutil
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
import yade.config
from membrane.parameters import SailParameters
from membrane.results.output import HistoryWriter, VtkSeries, is_whole_series, is_whole_table
from membrane.run import checkpoint, driver
from membrane.run.checkpoint import SCENE, STATE, Checkpoints, save_scene
from support import O, SceneTest, quiet, scratch
from yade import utils

FULL = Path("/dev/full")  # a disk without room


@contextlib.contextmanager
def largest_file(size):
    """Files that this process and its children write can be of so many bytes at most."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


class CheckpointTest(SceneTest):
    def setUp(self):
        super().setUp()
        self.folder = scratch() / self.id().rpartition(".")[2]
        self.folder.mkdir()

    def fill(self, count):
        """A scene of so many spheres, whose file does not fit into one buffer."""
        O.reset()
        O.bodies.append([utils.sphere((i, 0, 0), 0.3) for i in range(count)])


class TestFullDisk(CheckpointTest):
    def test_scene_for_which_there_is_no_room_is_a_sentence(self):
        self.fill(500)
        link = self.folder / SCENE
        link.symlink_to(FULL)
        with self.assertRaisesRegex(OSError, f"^{link}: could not be saved: .*No space left"):
            save_scene(link)

    def test_scene_is_saved_whole_or_refused_at_every_size(self):
        self.fill(500)
        path = self.folder / SCENE
        save_scene(path)
        size = path.stat().st_size
        for room in (0, 1, size // 2, size - 1):
            with self.subTest(room=room), largest_file(room):
                with self.assertRaisesRegex(OSError, "could not be saved"):
                    save_scene(path)
        with largest_file(size):
            save_scene(path)
        O.reset()
        O.load(str(path), quiet=True)
        self.assertEqual(len(O.bodies), 500)

    def test_checkpoint_that_fails_leaves_the_earlier_one_and_nothing_else(self):
        saved = Checkpoints(self.folder / "checkpoint", 0)
        self.fill(1)
        saved.save({"number": 1})
        (before,) = saved.folder.iterdir()
        self.fill(3000)
        with largest_file(20_000), self.assertRaises(OSError):
            saved.save({"number": 2})
        self.assertEqual(list(saved.folder.iterdir()), [before])
        self.assertEqual(saved.load(), {"number": 1})
        self.assertEqual(len(O.bodies), 1)

    def test_row_and_frame_for_which_there_is_no_room_name_the_file(self):
        table = self.folder / "history.csv"
        table.symlink_to(FULL)
        with self.assertRaisesRegex(OSError, f"could not be written: No space left.*{table}"):
            HistoryWriter(table, {"time": "s"})
        series = VtkSeries(self.folder, "film", [(0, 1, 2)])
        (self.folder / "film_000000.vtu").symlink_to(FULL)
        with self.assertRaisesRegex(OSError, "film_000000.vtu: could not be written: No space"):
            series.write(0.0, np.eye(3))


class TestDamage(CheckpointTest):
    def setUp(self):
        super().setUp()
        self.saved = Checkpoints(self.folder, 0)
        for number in (1, 2, 3):
            self.fill(number)
            self.saved.save({"number": number})

    def test_the_newest_two_are_kept(self):
        self.assertEqual(len(list(self.folder.iterdir())), 2)
        self.assertEqual(self.saved.load(), {"number": 3})

    def falls_back(self, damage):
        """Once the newest is damaged the one before is taken, and the newest is gone."""
        older, newest = sorted(self.folder.iterdir())
        damage(newest)
        self.assertEqual(Checkpoints(self.folder, 0).load(), {"number": 2})
        self.assertEqual(len(O.bodies), 2)
        self.assertEqual(list(self.folder.iterdir()), [older])

    def test_scene_with_other_bytes_cut_off_or_missing(self):
        content = (max(self.folder.iterdir()) / SCENE).read_bytes()
        middle = len(content) // 2
        damages = (b"", b"\0" * len(content), content[:middle], content[:-1], content + b"\0")
        flipped = content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]
        for bad in (*damages, flipped):
            self.falls_back(lambda newest: (newest / SCENE).write_bytes(bad))
            self.fill(3)
            self.saved.save({"number": 3})
        self.falls_back(lambda newest: (newest / SCENE).unlink())

    def test_state_with_another_value_cut_off_or_missing(self):
        text = (max(self.folder.iterdir()) / STATE).read_text()
        for bad in ("", "{", text[:-1], text.replace("3", "4", 1), '{"sum": 1}', "[1]"):
            self.falls_back(lambda newest: (newest / STATE).write_text(bad))
            self.fill(3)
            self.saved.save({"number": 3})
        self.falls_back(lambda newest: (newest / STATE).unlink())

    def test_scene_that_yade_cannot_load(self):
        def damage(newest):
            (newest / SCENE).write_bytes(b"no scene")
            content = json.loads((newest / STATE).read_text())
            del content["sum"]
            content["scene"] = checkpoint._sum_of(newest / SCENE)
            content["sum"] = checkpoint._sum(content)
            (newest / STATE).write_text(json.dumps(content))

        self.falls_back(damage)

    def test_scene_of_another_yade_is_not_even_tried(self):
        said = io.StringIO()
        with mock.patch.object(yade.config, "version", "2001.1 \n"), contextlib.redirect_stdout(
            said
        ):
            self.assertIsNone(self.saved.load())
        self.assertRegex(said.getvalue(), r"00002 was saved by YADE 20\S+; this is 2001\.1, which ")
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_state_whose_files_are_not_as_it_says(self):
        older = self.saved.load(lambda state: state["number"] < 3)
        self.assertEqual((older, len(O.bodies)), ({"number": 2}, 2))

    def test_all_damaged_is_a_new_beginning(self):
        self.assertIsNone(self.saved.load(lambda state: False))
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_damaged_table_and_series_are_found_out_and_longer_ones_are_whole(self):
        table = self.folder / "history.csv"
        series = VtkSeries(self.folder, "film", [(0, 1, 2)])
        with HistoryWriter(table, {"time": "s", "rate": "-"}) as history:
            for time in (0.0, 0.1):
                history.write({"time": time, "rate": 1 / 3})
                series.write(time, np.eye(3) + time)
            rows, frames = history.state(), series.state()
            history.write({"time": 0.2, "rate": 1.0})
            series.write(0.2, np.eye(3))

        def whole():
            return [is_whole_table(table, rows), is_whole_series(self.folder, "film", frames)]

        self.assertEqual(whole(), [True, True])
        with HistoryWriter(table, {"time": "s", "rate": "-"}, rows) as history:
            self.assertEqual(history.state(), rows)
        going_on = VtkSeries(self.folder, "film", [(0, 1, 2)], frames["times"])
        self.assertEqual(going_on.state(), frames)
        for path in (table, self.folder / "film_000001.vtu"):
            content = path.read_bytes()
            for bad in (content[:-1], b"\0" * len(content), b""):
                path.write_bytes(bad)
                self.assertIn(False, whole())
            path.unlink()
            self.assertIn(False, whole())
            path.write_bytes(content)
        self.assertEqual(whole(), [True, True])


class TestPowerCut(CheckpointTest):
    def test_what_a_checkpoint_tells_of_is_on_the_disk_before_it_has_its_name(self):
        """So are its own files, and its name before an older one is removed."""
        settled, names = {}, []
        really = {"fsync": os.fsync, "rename": os.rename, "rmtree": shutil.rmtree}

        def fsync(handle):
            really["fsync"](handle)
            about = os.fstat(handle)
            settled[Path(os.readlink(f"/proc/self/fd/{handle}"))] = about.st_size, about.st_mtime_ns

        def on_the_disk(paths):
            for path in paths:
                about = path.stat()
                self.assertEqual(settled.get(path), (about.st_size, about.st_mtime_ns), path)

        def rename(old, new):
            shapes = sorted((self.folder / "shapes").glob("*.vtu"))
            if shapes:
                on_the_disk([self.folder / "history.csv", *shapes, shapes[0].parent, self.folder])
            on_the_disk([*old.iterdir(), old])
            really["rename"](old, new)
            names.append((new, len(shapes)))

        def rmtree(path, *options, **more):
            if path.name.isdecimal():
                on_the_disk([names[-1][0].parent])
            really["rmtree"](path, *options, **more)

        p = SailParameters(
            fold_lines=3,
            inner_width=0.15,
            duration=0.006,
            shapes_interval=0.002,
            spin_up_tolerance=1e-2,
        )
        saved = Checkpoints(self.folder / "checkpoint", 0)
        watched = {"os.fsync": fsync, "os.rename": rename, "shutil.rmtree": rmtree}
        with contextlib.ExitStack() as stack:
            stack.enter_context(quiet())
            for name, function in watched.items():
                stack.enter_context(mock.patch(name, function))
            driver.deploy(p, self.folder, pictures=False, checkpoints=saved, page=False)
        self.assertGreater(max(shapes for _, shapes in names), 4)  # of both series
        self.assertEqual(min(shapes for _, shapes in names), 0)


if __name__ == "__main__":
    unittest.main()
