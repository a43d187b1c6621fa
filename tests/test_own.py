# SPDX-License-Identifier: GPL-2.0-or-later
"""What is not ours is neither removed nor written to, whatever it is called or links lead to."""

import json
import os
import unittest
from contextlib import suppress
from pathlib import Path

from membrane.files import replace_text
from membrane.parameters import SailParameters
from membrane.results import own
from membrane.results.output import VtkSeries
from membrane.results.unfinished import RESULT, RESULTS, SAVED, UNFINISHED, new_results
from membrane.run.case import run_case
from support import scratch

QUICK = True


def found(folder):
    """What is in a folder: text of files, targets of links, "" for folders, by path."""
    return {str(path.relative_to(folder)): look(path) for path in sorted(folder.rglob("*"))}


def look(path):
    if path.is_symlink():
        return f"-> {os.readlink(path)}"
    return path.read_text() if path.is_file() else ""


class OwnTest(unittest.TestCase):
    def setUp(self):
        self.folder = scratch() / self.id().rpartition(".")[2]
        self.folder.mkdir()

    def stays(self, work, sentence):
        """Some work is refused and leaves all in the folder as it is."""
        before = found(self.folder)
        self.assertTrue(before)
        with self.assertRaisesRegex(ValueError, sentence):
            work()
        self.assertEqual(found(self.folder), before)

    def precious(self, folder):
        """A folder of the user's, with a chapter in it."""
        folder.mkdir()
        (folder / "chapter1.txt").write_text("precious")
        return folder


class TestFolders(OwnTest):
    def hold(self, folder):
        with own.held(folder, "busy"):
            self.fail("not refused")

    def test_folder_of_another_is_refused_whatever_is_in_it(self):
        for name, lock in (("none", None), ("empty", ""), ("another", "locked\n")):
            with self.subTest(name):
                folder = self.precious(self.folder / name)
                if lock is not None:  # as earlier versions had it, or another program has
                    (folder / own.LOCK).write_text(lock)
                self.stays(lambda: self.hold(folder), f"^{folder} was not made by this version")

    def test_lock_that_is_no_file_of_ours_is_refused(self):
        target = self.folder / "letter.txt"
        target.write_text("Dear")
        for name, make in (("link", os.symlink), ("hard", os.link)):
            (self.folder / name).mkdir()
            make(target, self.folder / name / own.LOCK)
            self.stays(lambda: self.hold(self.folder / name), "was not made by this version")
        (self.folder / "pipe").mkdir()
        os.mkfifo(self.folder / "pipe" / own.LOCK)
        self.stays(lambda: self.hold(self.folder / "pipe"), "was not made by this version")

    def test_link_to_a_folder_of_ours_is_refused(self):
        with own.held(self.folder / "ours"):
            pass
        for name, target in (("link", "ours"), ("dangling", "nowhere")):
            (self.folder / name).symlink_to(target)
            self.stays(lambda: self.hold(self.folder / name), "was not made by this version")

    def test_link_within_a_folder_of_ours_is_not_followed(self):
        ours, others = self.folder / "ours", self.precious(self.folder / "others")
        with own.held(ours):
            (ours / "shapes").mkdir()
            (ours / "shapes" / "link").symlink_to(others)
        self.stays(lambda: self.hold(ours), f"{ours}/shapes/link is a symbolic link")
        (ours / "shapes" / "link").unlink()
        with own.held(ours):
            (ours / "shapes" / "link").symlink_to(others)
            (ours / "link").symlink_to(others)
            own.remove(ours)
        self.assertEqual(found(self.folder), {"others": "", "others/chapter1.txt": "precious"})

    def test_folder_whose_making_was_cut_off_is_ours(self):
        for number, make in enumerate((Path.mkdir, lambda path: own._open_lock(path))):
            folder = self.folder / str(number)
            make(folder)
            with own.held(folder, "busy"):
                own.remove(folder)
            self.assertFalse(folder.exists())

    def test_processes_that_make_and_remove_it_at_once_hold_it_one_by_one(self):
        ours, count = self.folder / "ours", self.folder / "count"
        count.write_text("0")

        def work():
            for _ in range(40):
                with own.held(ours):
                    os.close(os.open(ours / "only", os.O_CREAT | os.O_EXCL))
                    count.write_text(str(int(count.read_text()) + 1))
                    own.remove(ours)

        workers = []
        for _ in range(6):
            if not (child := os.fork()):
                try:
                    work()
                finally:
                    os._exit(0)
            workers.append(child)
        for child in workers:
            os.waitpid(child, 0)
        self.assertEqual(count.read_text(), str(6 * 40))
        self.assertFalse(ours.exists())


class TestCommands(OwnTest):
    """Each is refused before anything is built."""

    def case(self, name):
        """What runs a case in a folder."""
        return lambda: run_case(SailParameters(), self.folder / name)

    def test_unfinished_of_another_in_the_folder_of_a_case_survives(self):
        (self.folder / "thesis").mkdir()
        self.precious(self.folder / "thesis" / UNFINISHED)
        self.stays(self.case("thesis"), f"thesis/{UNFINISHED} was not made")
        (self.folder / "link").mkdir()
        (self.folder / "link" / UNFINISHED).symlink_to(self.folder / "thesis" / UNFINISHED)
        self.stays(self.case("link"), f"link/{UNFINISHED} was not made")
        (self.folder / "dangling").symlink_to("nowhere")
        self.stays(self.case("dangling"), "is missing; choose another folder")

    def test_case_does_not_mix_with_what_is_in_its_folder(self):
        self.precious(self.folder / "thesis")
        self.stays(self.case("thesis"), "thesis/case.json: is missing; choose another folder")
        with new_results(self.folder / "run") as part:
            (part / "history.csv").write_text("ours")
        self.stays(self.case("run"), "run/case.json: is missing; choose another folder")
        with suppress(ZeroDivisionError), new_results(self.folder / "run") as part:
            (part / "history.csv").write_text("half")
            1 / 0
        self.stays(self.case("run"), "run holds a run: choose another folder")

    def test_case_is_no_run_whose_results_may_be_replaced(self):
        with new_results(self.folder, own.CASE, self.ABOUT) as part:
            (part / RESULT).write_text("ours")
        self.refused(f"{self.folder} holds a case: choose another folder")

    def test_case_that_can_go_on_is_not_lost_to_another_run(self):
        with suppress(ZeroDivisionError), new_results(self.folder, own.CASE, self.ABOUT) as part:
            (part / SAVED).mkdir()
            1 / 0
        self.refused(f"{part} holds a case that can go on; to lose what it has done, remove {part}")
        for change in ({"sail": "miura"}, {"parameters": {"beta": 4.0}}, {"sum_of_file": "ab"}):
            with self.subTest(**change):
                self.refused("holds another case: ", own.CASE, {**self.ABOUT, **change})
        with new_results(self.folder, own.CASE, {**self.ABOUT, "versions": {"yade": "2"}}) as part:
            self.assertFalse((part / SAVED).exists())

    ABOUT = {"sail": "sheet", "parameters": {"beta": 3.0}, "versions": {"yade": "1"}}

    def test_unfinished_of_another_survives_and_what_a_link_of_that_name_leads_to(self):
        others = self.precious(self.folder / "others")
        (self.folder / own.LOCK).write_text("kept")
        (self.folder / UNFINISHED).symlink_to(others)
        self.refused(f"{UNFINISHED} was not made by this version")
        (self.folder / UNFINISHED).unlink()
        others.rename(self.folder / UNFINISHED)
        self.refused(f"{UNFINISHED} was not made by this version")

    def refused(self, sentence, *about):
        def work():
            with new_results(self.folder, *about):
                self.fail("not refused")

        self.stays(work, sentence)

    def test_results_of_another_are_refused_before_the_run(self):
        for name in RESULTS[own.RUN]:
            self.precious(self.folder / name)
            self.refused(f"{self.folder}/{name} was not made by this version")
            (self.folder / name).rename(self.folder / f"users_{name}")
        with new_results(self.folder) as part:
            (part / "history.csv").write_text("ours")
        (self.folder / "sail.gif").symlink_to("users_shapes/chapter1.txt")
        self.refused("sail.gif was not made by this version")

    def test_what_the_user_put_there_meanwhile_is_not_replaced(self):
        with self.assertRaisesRegex(ValueError, "history.csv was not made"):
            with new_results(self.folder) as part:
                (part / "history.csv").write_text("new")
                (self.folder / "history.csv").write_text("of the user")
        self.assertEqual((self.folder / "history.csv").read_text(), "of the user")
        self.assertEqual((self.folder / UNFINISHED / "history.csv").read_text(), "new")

    def test_results_of_another_kind_stay(self):
        with new_results(self.folder, own.CALIBRATION) as part:
            (part / "runs.csv").write_text("ours")
        self.refused(f"{self.folder} holds a calibration")
        own.write_list(self.folder, own.SWEEP, ["cases.csv"])
        self.refused(f"{self.folder} holds a sweep")

    def test_list_of_another_is_a_sentence(self):
        for text in (
            "",
            "{}",
            '{"made": ["../x"]}',
            '{"made": [".."]}',
            '{"made": ["a\\u0000/b"]}',
        ):
            (self.folder / own.LIST).write_text(text)
            self.refused(f"{self.folder}/{own.LIST}: ")

    def test_films_and_pages_made_later_are_ours_and_those_of_others_stay(self):
        with new_results(self.folder) as part:
            (part / "history.csv").write_text("ours")
        (self.folder / "sail.gif").write_text("of the user")
        self.stays(lambda: own.add_to_list(self.folder, ["report.html", "sail.gif"]), "sail.gif")
        own.add_to_list(self.folder, ["report.html"])
        (self.folder / "report.html").write_text("made later")
        (self.folder / "sail.gif").unlink()
        with new_results(self.folder) as part:
            (part / "history.csv").write_text("new")
        content = found(self.folder)
        self.assertEqual(json.loads(content.pop(own.LIST))["made"], ["history.csv"])
        self.assertEqual(content, {"history.csv": "new"})


class TestFiles(OwnTest):
    def test_link_is_replaced_and_its_target_stays(self):
        target = self.folder / "target"
        target.write_text("precious")
        for name in ("cases.csv", "cases.csv.part"):
            (self.folder / name).symlink_to(target)
        replace_text(self.folder / "cases.csv", "new")
        self.assertEqual(
            found(self.folder),
            {"target": "precious", "cases.csv": "new", "cases.csv.part": f"-> {target}"},
        )

    def test_new_file_can_be_read_by_those_who_may(self):
        before = os.umask(0o027)
        try:
            replace_text(self.folder / "table", "new")
        finally:
            os.umask(before)
        self.assertEqual((self.folder / "table").stat().st_mode & 0o777, 0o640)

    def test_series_removes_its_own_frames_alone(self):
        others = ("film_notes.vtu", "film_1.vtu", "film_000001.vtu.txt", "my_film_000001.vtu")
        for name in (*others, "film_000007.vtu"):
            (self.folder / name).write_text("")
        VtkSeries(self.folder, "film", [(0, 1, 2)])
        self.assertEqual(set(found(self.folder)), set(others))


if __name__ == "__main__":
    unittest.main()
