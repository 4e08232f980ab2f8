#!/usr/bin/env python3
"""A person's voice (espeak-ng) describes the building to the robot's ears (listen, pocketsphinx): the names land on the map, and the robot's
answers are spoken. Skipped aloud where the programs are not installed."""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
import wave

import rospy
import rostest
from std_msgs.msg import String

sys.dont_write_bytecode = True
from conversation_test import Robot, building
from localization_rig import WAIT, Listener, wait_until

NEEDED = ("espeak-ng", "pocketsphinx_continuous")
MODEL = "/usr/share/pocketsphinx/model/en-us/en-us"
MISSING = [n for n in NEEDED if shutil.which(n) is None] + ([] if os.path.isdir(MODEL) else [MODEL])
NAMES = ["corridor", "kitchen", "library", "workshop", "meeting room", "reception"]
SENTENCES = ["You are in the corridor.", "On your right you have the kitchen, then the library, then the workshop.", "In front of you is the reception."]
CORRIDOR = (10.0, 8.0)  # in the office


@unittest.skipIf(MISSING, f"the robot's voice is not tested: {', '.join(MISSING)} not installed (scripts/deps)")
class VoiceTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.ears, cls.mouth = (os.path.join(cls.folder.name, n) for n in ("ears", "mouth"))
        os.mkdir(cls.ears)
        os.mkdir(cls.mouth)
        cls.robot = Robot("spoken", building(cls.folder.name, "office"), ask="never")
        assert cls.robot.loaded
        wait_until(lambda: cls.robot.maps.messages, "no map")
        cls.robot.stand(*CORRIDOR)
        cls.heard = Listener("/spoken/human_text", String)
        environment = dict(os.environ, ROS_NAMESPACE="spoken")
        cls.bridges = [subprocess.Popen(["rosrun", "hyselam_topo", *command], env=environment) for command in (
            ["listen", f"_sounds:={cls.ears}", f"_names:={','.join(NAMES)}"], ["speak", f"_sounds:={cls.mouth}"])]
        wait_until(lambda: cls.heard.subscriber.get_num_connections() > 1, "the ears are not open")
        wait_until(lambda: cls.robot.answers.subscriber.get_num_connections() > 0 and b"/spoken/speak" in subprocess.run(
            ["rosnode", "list"], stdout=subprocess.PIPE).stdout, "the mouth is shut")

    @classmethod
    def tearDownClass(cls):
        for bridge in cls.bridges:
            bridge.terminate()
        for bridge in cls.bridges:
            bridge.wait(WAIT)
        cls.heard.close()
        cls.robot.close()

    def speak(self, number, text):
        """A person says it; what the robot's ears make of it."""
        before = len(self.heard.messages)
        draft = os.path.join(self.ears, "draft.part")
        subprocess.run(["espeak-ng", "-v", "en-us", "-s", "135", "-w", draft, "--stdin"], input=text.encode(), check=True)
        os.replace(draft, os.path.join(self.ears, f"{number:03d}.wav"))
        wait_until(lambda: len(self.heard.messages) > before, f"nothing was heard of '{text}'")
        return " ".join(m.data for m in self.heard.messages[before:])

    def named(self):
        return {w.text for p in self.robot.maps.messages[-1].places for w in p.words}

    def test_names_that_are_spoken_land_on_the_map_and_answers_are_spoken(self):
        answers = len(self.robot.answers.messages)
        for number, sentence in enumerate(SENTENCES):
            print(f"said: {sentence} heard: {self.speak(number, sentence)}")
        wait_until(lambda: {"corridor", "kitchen", "library", "workshop", "reception"} <= self.named(), lambda: f"named only {self.named()}")
        wait_until(lambda: len(self.robot.answers.messages) > answers, "no answers")
        wait_until(lambda: any(n.endswith(".wav") for n in os.listdir(self.mouth)), "nothing was spoken")
        with wave.open(os.path.join(self.mouth, sorted(n for n in os.listdir(self.mouth) if n.endswith(".wav"))[0])) as sound:
            self.assertGreater(sound.getnframes(), sound.getframerate() // 2)

    def test_a_file_that_is_no_sound_is_refused_and_the_ears_stay_open(self):
        with open(os.path.join(self.ears, "900.wav"), "wb") as file:
            file.write(b"no sound")
        self.assertIn("stop", self.speak(901, "Stop."))


if __name__ == "__main__":
    rospy.init_node("voice_test")
    rostest.rosrun("hyselam_bringup", "voice_test", VoiceTest)
