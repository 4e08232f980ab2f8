"""Sentences for the robot, one after the other: a stop cancels those that wait, and one that sends the robot is taken back where its speaker
may not send it. Free of ROS."""
import asyncio
import time

from .requests import Refused

OLDEST = 10.0  # [s] that a sentence may wait for those before it
ANSWER_WAIT = 30.0  # [s] for the answer
VETO_WAIT = 1.0  # [s] within which a sentence sets the robot going, also where the machine is busy
STEP = 0.05  # [s] between two looks


def go_to(place, language):
    """By the map's own name of the place: one that people gave could be, or hold, another sentence."""
    return ("Vá para {}." if language == "pt" else "Go to {}.").format(place["e"])


def stop(language):
    """In words of one language only, where it shall be answered in that."""
    return {"en": "Stop moving.", "pt": "Pare."}.get(language, "Stop.")


class Sentences:
    """tell(text, check): a future of the answers, which calls check() right before the robot is told; stop(): stops the robot; ways(): how
    often it was set going; forwarded(): how often a sentence went to who answers later, within patience() seconds."""

    def __init__(self, tell, stop, ways, forwarded=lambda: 0, patience=lambda: 3.0, clock=time.monotonic):
        self._tell, self._stop, self._ways, self._forwarded, self._patience, self._clock = tell, stop, ways, forwarded, patience, clock
        self._lock, self._told = None, None
        self._stops = self._said = 0

    def stopped(self):
        """Somebody stopped the robot: nothing that was said before is told to it any more."""
        self._stops += 1

    async def say(self, text, may_drive):
        """The answers. @throws Refused."""
        stops, came = self._stops, self._clock()

        def check():
            if self._stops != stops:
                raise Refused("stopped", "the robot was stopped meanwhile: it was not told this")
            if self._clock() - came > OLDEST:
                raise Refused("busy", "the robot was busy with what was said before: it was not told this")
        if self._lock is None:
            self._lock = asyncio.Lock()
        async with self._lock:
            check()
            if self._told is not None and not self._told.done():
                raise Refused("busy", "the robot has not answered what was said before")
            self._said += 1
            before = self._ways(), self._forwarded()
            self._told = told = asyncio.ensure_future(self._tell(text, check))
            watch = asyncio.ensure_future(self._watch(told, stops, self._said, before, may_drive))
            try:
                return await asyncio.wait_for(asyncio.shield(told), ANSWER_WAIT)
            except asyncio.TimeoutError:
                raise Refused("no_answer", f"no answer within {ANSWER_WAIT:.0f} s")
            finally:
                # Whatever it answered. Where it has not, the watch goes on without us.
                if not may_drive and told.done() and await asyncio.shield(watch):
                    raise Refused("not_allowed", "this would send the robot: that needs the role drive. It was stopped")

    async def _watch(self, told, stops, number, before, may_drive):
        """True: it set the robot going, which its speaker may not."""
        await asyncio.wait([told])
        if told.exception() is not None and getattr(told.exception(), "code", "") == "stopped":
            return False  # it was never told
        if self._stops != stops:
            self._stop()  # the robot may have heard the stop before the sentence
        ways, forwarded = before
        end, later = self._clock() + VETO_WAIT, False
        while self._clock() < end and (not may_drive or number == self._said):
            await asyncio.sleep(STEP)
            if not later and self._forwarded() != forwarded:
                end, later = end + self._patience(), True
            if self._ways() == ways:
                continue
            if not may_drive:
                self._stop()
                return True
            if self._stops != stops:
                self._stop()
                return False
        return False
