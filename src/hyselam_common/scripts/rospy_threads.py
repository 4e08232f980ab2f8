"""Imported for what it does: rospy 1.15.9, that of Debian 11, ends by asking its threads isAlive(), which Python 3.9 calls is_alive() only.
Without it each program ends with a traceback, and one that calls rospy.signal_shutdown() fails."""
import threading

if not hasattr(threading.Thread, "isAlive"):
    threading.Thread.isAlive = threading.Thread.is_alive
