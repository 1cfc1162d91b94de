#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The reference itself, against figures that the manual and the specification print, and the differential test's own ability to
find a difference and to make it small."""

import unittest
from fractions import Fraction

import differential
import language
from compare import Comparison, Result, reference
from motion import Motion
from story import read


def motion(start, parts):
    return Motion(0, start, parts, True, lambda clause: None)


class Motions(unittest.TestCase):
    def test_R4_the_compound_motion_of_the_manual_takes_24_469167_seconds(self):
        table = [(2000, 500, 2000), (2000, 2000, 2000), (5000, 500, 2000)]
        table += [(5000, 3000, 1000), (2000, 1500, 1000), (2000, 500, 1000)]
        self.assertEqual(motion(100, table).tick(18000), 24_469_167)

    def test_R1_a_trapezoid_ends_at_twice_the_ramp_and_the_way_between(self):
        self.assertEqual(motion(100, [(1000, 1000, 2000)]).tick(1000), 1_405_000)

    def test_R1_a_triangle_has_the_peak_that_its_way_allows(self):
        triangle = motion(100, [(1000, 3000, 2000)])
        self.assertEqual(triangle.legs[0].q1, Fraction(100**2 + 2000 * 1000))

    def test_R3_V_below_S_is_a_constant_speed(self):
        self.assertEqual([motion(100, [(5, 50, 2000)]).tick(k) for k in (1, 5)], [20_000, 100_000])

    def test_R5_a_whole_way_adds_no_step(self):
        endless = motion(100, [(None, 1000, 2000)])
        while endless.due <= 1_000_000:
            endless.step()
        endless.stop(1_000_000)
        self.assertEqual(endless.end, 1045)


class Texts(unittest.TestCase):
    def test_5_blanks_and_comments_separate(self):
        self.assertEqual(language.parse(b"I 01 H 20{x}G += - 5"), [("I", 1, "H", 20), ("G", "+"), ("=", -5)])

    def test_P1_the_first_error_is_reported(self):
        for text, flag, character in ((b"F0", 1, "F"), (b"Q F0", 2, "Q"), (b"I01X5", 1, "I"), (b"{", 2, "{"), (b"=+5", 1, "=")):
            with self.assertRaises(language.Refused) as caught:
                language.parse(text)
            self.assertEqual((caught.exception.flag, chr(caught.exception.character)), (flag, character))


class Differences(unittest.TestCase):
    story = read("send 0 1 W5 F3 R T01\nsend 0 2 T02\nask 90000 4 1\nend 100000")

    def test_equal_results_are_equal(self):
        comparison = Comparison(self.story, reference(self.story), reference(self.story))
        self.assertIsNone(comparison.hard)
        self.assertEqual(comparison.soft, set())

    def test_a_pulse_of_a_single_motion_a_tick_late_is_a_difference(self):
        other = reference(self.story)
        other.pulses[1][1] += 1
        self.assertIn("motor 1 pulse 2", Comparison(self.story, reference(self.story), other).hard[1])

    def test_a_story_is_made_as_small_as_its_difference(self):
        class NoOutputs:
            """A unit that forgets its outputs."""

            @staticmethod
            def run(story):
                result = reference(story)
                result.notes.pop((0, "outputs"), None)
                return result

        found, _, _ = differential.difference(NoOutputs, self.story)
        story, _ = differential.minimise(NoOutputs, self.story, found)
        self.assertIn(story.lines()[:-1], (["send 0 2 T02"], ["send 0 1 T01"]))

    def test_a_missing_answer_is_a_difference(self):
        other = Result()
        self.assertIsNotNone(Comparison(self.story, reference(self.story), other).hard)


if __name__ == "__main__":
    unittest.main()
