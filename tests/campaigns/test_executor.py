"""Workers start whole, whenever Ctrl-C comes."""

import os
import signal
import socket
import threading

from meso_robust.campaigns.executor import deaf_to_ctrl_c


def test_ctrl_c_heard_by_another_thread_waits_until_a_worker_is_started() -> None:
    done = threading.Event()
    thread = threading.Thread(target=done.wait)  # its mask is open: the system picks it
    heard, written = socket.socketpair()
    written.setblocking(False)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    wakeup = signal.set_wakeup_fd(written.fileno())
    thread.start()
    order = []
    try:
        with deaf_to_ctrl_c():
            os.kill(os.getpid(), signal.SIGINT)
            heard.recv(1)
            order.append("started")
    except KeyboardInterrupt:
        order.append("interrupted")
    finally:
        done.set()
        thread.join()
        signal.set_wakeup_fd(wakeup)
        signal.signal(signal.SIGINT, before)
        heard.close()
        written.close()

    assert order == ["started", "interrupted"]
