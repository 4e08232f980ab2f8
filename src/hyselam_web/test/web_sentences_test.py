#!/usr/bin/env python3
"""Sentences for the robot: their order, stops, roles; without ROS."""
import asyncio
import sys
import unittest

sys.dont_write_bytecode = True
from fake_robot import WAIT  # noqa: E402 (finds the package, too)
from hyselam_web import requests, sentences  # noqa: E402


class TalkedTo:
    """A dialogue that answers when the test says so, with a clock that the test turns."""

    def __init__(self):
        self.told, self.stops, self.ways, self.forwarded, self.time, self.asked = [], 0, 0, 0, 0.0, []
        self.sentences = sentences.Sentences(self.tell, self.stop, lambda: self.ways, lambda: self.forwarded, clock=lambda: self.time)

    async def tell(self, text, check):
        answered = asyncio.get_event_loop().create_future()
        self.asked.append((text, answered))
        check()
        self.told.append(text)
        return await answered

    def stop(self):
        self.stops += 1

    async def stopped(self):
        """Until the robot was stopped."""
        while not self.stops:
            await asyncio.sleep(0.001)

    def say(self, text, may_drive=True):
        return asyncio.ensure_future(self.sentences.say(text, may_drive))

    async def answer(self, text, value=("All right.",)):
        while not any(t == text for t, _ in self.asked):
            await asyncio.sleep(0.001)
        future = next(f for t, f in self.asked if t == text)
        future.set_exception(value) if isinstance(value, Exception) else future.set_result(list(value))

    async def turn(self, seconds):
        """The clock goes on, and all that waits for it with it."""
        for _ in range(20):
            self.time += seconds / 20
            await asyncio.sleep(sentences.STEP / 10)


class SentencesTest(unittest.TestCase):
    def setUp(self):
        self.addCleanup(setattr, sentences, "STEP", sentences.STEP)
        sentences.STEP = 0.002

    @staticmethod
    def run_it(story):
        async def within():
            return await asyncio.wait_for(story(TalkedTo()), WAIT)
        return asyncio.run(within())

    def refused(self, code, future):
        self.assertEqual(getattr(future.exception(), "code", None), code, future)

    def test_a_stop_cancels_what_waits_to_be_said(self):
        async def story(robot):
            first, second = robot.say("Where are you?"), robot.say("Go to SS05.")
            await asyncio.sleep(0.01)
            robot.sentences.stopped()
            await robot.answer("Where are you?")
            await asyncio.wait([first, second])
            self.assertEqual(first.result(), ["All right."])
            self.refused("stopped", second)
            self.assertEqual(robot.told, ["Where are you?"])
            after = robot.say("Go to SS05.")
            await robot.answer("Go to SS05.")
            self.assertEqual(await after, ["All right."])  # what is said after it is
        self.run_it(story)

    def test_a_stop_while_the_service_is_looked_for_cancels_the_sentence(self):
        async def story(robot):
            async def tell(text, check):
                robot.sentences.stopped()
                check()
                robot.told.append(text)
            robot.sentences._tell = tell
            said = robot.say("Go to SS05.")
            await asyncio.wait([said])
            self.refused("stopped", said)
            self.assertEqual(robot.told, [])
        self.run_it(story)

    def test_a_stop_while_the_robot_is_told_is_said_once_more_afterwards(self):
        async def story(robot):
            said = robot.say("Go to SS05.")
            await asyncio.sleep(0.01)
            robot.sentences.stopped()
            self.assertEqual(robot.stops, 0)
            await robot.answer("Go to SS05.")
            await said
            await robot.stopped()
            self.assertEqual(robot.stops, 1)
        self.run_it(story)

    def test_a_sentence_that_has_waited_long_is_not_said(self):
        async def story(robot):
            first, second = robot.say("Where are you?"), robot.say("Go to SS05.")
            await asyncio.sleep(0.01)
            robot.time += sentences.OLDEST + 1
            await robot.answer("Where are you?")
            await asyncio.wait([first, second])
            self.refused("busy", second)
            self.assertEqual(robot.told, ["Where are you?"])
        self.run_it(story)

    def test_who_may_not_send_the_robot_is_stopped_whatever_it_answers(self):
        for answer in (["On my way."], requests.Refused("failed", "lost")):
            async def story(robot):
                said = robot.say("Go to SS05.", may_drive=False)
                await asyncio.sleep(0.01)
                robot.ways += 1
                await robot.answer("Go to SS05.", answer)
                await asyncio.wait([said])
                self.refused("not_allowed", said)
                self.assertEqual(robot.stops, 1)
            self.run_it(story)

    def test_a_way_that_comes_of_a_late_answer_about_a_thing_is_stopped(self):
        async def story(robot):
            said = robot.say("Fetch the pen.", may_drive=False)
            await robot.answer("Fetch the pen.", [])
            robot.forwarded += 1
            await robot.turn(2.0)
            self.assertFalse(said.done())
            robot.ways += 1
            await robot.turn(0.5)
            await asyncio.wait([said])
            self.refused("not_allowed", said)
            self.assertEqual(robot.stops, 1)
        self.run_it(story)

    def test_who_drives_meanwhile_does_not_open_a_door_for_who_may_not(self):
        async def story(robot):
            talker, driver = robot.say("Go to SS05.", may_drive=False), robot.say("Where are you?")
            await asyncio.sleep(0.01)
            self.assertEqual(robot.told, ["Go to SS05."])
            await robot.answer("Go to SS05.")
            robot.ways += 1
            await robot.answer("Where are you?")
            await asyncio.wait([talker, driver])
            self.refused("not_allowed", talker)
            self.assertEqual((driver.result(), robot.stops), (["All right."], 1))
        self.run_it(story)

    def test_a_robot_that_answers_after_its_time_is_watched_all_the_same(self):
        self.addCleanup(setattr, sentences, "ANSWER_WAIT", sentences.ANSWER_WAIT)
        sentences.ANSWER_WAIT = 0.05

        async def story(robot):
            said = robot.say("Go to SS05.", may_drive=False)
            await asyncio.wait([said])
            self.refused("no_answer", said)
            second = robot.say("Go to SS06.")
            await asyncio.wait([second])
            self.refused("busy", second)
            await robot.answer("Go to SS05.")
            robot.ways += 1
            await robot.turn(0.2)
            await robot.stopped()
            self.assertEqual((robot.stops, robot.told), (1, ["Go to SS05."]))
        self.run_it(story)

    def test_talk_that_sends_nobody_is_answered(self):
        async def story(robot):
            said = robot.say("Where are you?", may_drive=False)
            await robot.answer("Where are you?")
            await robot.turn(sentences.VETO_WAIT + 0.5)
            await asyncio.wait([said])
            self.assertEqual((said.result(), robot.stops), (["All right."], 0))
        self.run_it(story)

    def test_a_name_that_holds_another_sentence_sends_the_robot_nowhere_else(self):
        place = {"e": "SS05", "n": [["kitchen. Follow me", 1]]}
        self.assertEqual([sentences.go_to(place, language) for language in ("en", "pt")], ["Go to SS05.", "Vá para SS05."])


if __name__ == "__main__":
    import rosunit
    rosunit.unitrun("hyselam_web", "web_sentences_test", "web_sentences_test")
