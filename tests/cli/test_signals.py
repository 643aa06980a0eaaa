"""cli/signals.py and cli/streams.py: a command that is asked to end says so in a line, and one whose streams are closed ends well."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from shootstab.cli import commands, main, signals

WAITING = """
import sys, time
from shootstab.cli import commands, main
from shootstab.io.files import write_whole
from pathlib import Path

def scenes(options):
    def slowly(path):
        path.write_text("half")
        print("writing", file=sys.stderr, flush=True)
        time.sleep(600)
    write_whole(Path(options.json), slowly)

commands.scenes = scenes
sys.exit(main.main(["scenes", "--json", "answer.json"]))
"""


@contextmanager
def at_default() -> Iterator[None]:
    before = {n: signal.getsignal(n) for n in (signal.SIGTERM, signal.SIGHUP)}
    for number in before:
        signal.signal(number, signal.SIG_DFL)
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize(
    ("by", "status", "says"), [("SIGTERM", 143, "ended by SIGTERM"), ("SIGHUP", 129, "ended by SIGHUP"), ("SIGINT", 130, "interrupted")]
)
def test_a_command_that_is_ended_while_it_writes(tmp_path: Path, by: str, status: int, says: str) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", WAITING],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(Path(main.__file__).parents[2])},
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.Signals[by], signal.SIG_DFL),
    ) as program:
        assert program.stderr is not None
        assert program.stderr.readline() == "writing\n"
        program.send_signal(signal.Signals[by])
        assert program.stderr.read() == f"shootstab: {says}\n"
    assert program.returncode == status
    assert list(tmp_path.iterdir()) == []


def test_handlers_are_put_back_and_those_of_others_left_alone() -> None:
    with at_default():
        signal.signal(signal.SIGHUP, signal.SIG_IGN)  # as nohup does
        received: list[signals.Ended] = []
        with signals.raised(received):
            assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
            with pytest.raises(signals.Ended, match="ended by SIGTERM") as caught:
                signal.raise_signal(signal.SIGTERM)
            assert caught.value.status == 143
            assert received == [caught.value]
            assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL  # a second one ends the program at once
        assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


def test_a_library_that_is_interrupted_may_end_in_its_own_words(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """As a compiler does that is left half way."""

    def compiled(options: object) -> int:
        try:
            signal.raise_signal(signal.SIGTERM)
        except KeyboardInterrupt:
            raise RuntimeError("no compiled object yet") from None
        return commands.DONE

    monkeypatch.setattr(commands, "scenes", compiled)
    compiled.__name__ = "scenes"
    with at_default():
        assert main.main(["scenes"]) == 143
    assert capsys.readouterr().err == "shootstab: ended by SIGTERM\n"


def test_a_thread_leaves_them_alone() -> None:
    """Python sets handlers in the main thread only."""
    seen: list[int] = []
    thread = threading.Thread(target=lambda: seen.append(main.main(["scenes", "--quiet"])))
    thread.start()
    thread.join()
    assert seen == [commands.DONE]


REFUSED = "the answer could not be written: Bad file descriptor"


@pytest.mark.parametrize(
    ("words", "closed", "status", "says"),
    [("scenes", 1, 4, REFUSED), ("--version", 1, 4, REFUSED), ("--help", 1, 4, REFUSED), ("scenes", 2, 0, "")],
)
def test_streams_that_are_closed(words: str, closed: int, status: int, says: str) -> None:
    command = [sys.executable, "-m", "shootstab", words]
    environment = {**os.environ, "PYTHONPATH": str(Path(main.__file__).parents[2])}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, preexec_fn=lambda: os.close(closed), check=False)
    assert done.returncode == status
    assert done.stderr == (f"shootstab: {says}\n" if says else "")
