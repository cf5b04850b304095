"""The package as others use it: types, documentation, other threads."""

from __future__ import annotations

import ast
import doctest
import inspect
import os
import re
import runpy
import signal
import sys
import threading
import types
import typing
import unittest
from collections.abc import Callable
from importlib import resources

import numpy
import portray

from programs import GLASS, ROOT, InFolder


class Types(unittest.TestCase):
    def test_the_stub_has_every_function_and_argument(self) -> None:
        from portray import _core

        stub = resources.files("portray").joinpath("_core.pyi").read_text()
        found = {}
        for node in ast.parse(stub).body:
            if isinstance(node, ast.FunctionDef):
                found[node.name] = [argument.arg for argument in node.args.args]
        native = {name: f for name, f in vars(_core).items() if inspect.isbuiltin(f)}
        expected = {name: list(inspect.signature(f).parameters) for name, f in native.items()}
        self.assertEqual(found, expected)
        self.assertTrue(resources.files("portray").joinpath("py.typed").is_file())

    def test_everything_public_is_annotated_and_documented(self) -> None:
        for name in portray.__all__:
            thing = getattr(portray, name)
            self.assertTrue(thing.__doc__, name)
            if inspect.isfunction(thing):
                hints = typing.get_type_hints(thing)
                self.assertEqual(set(inspect.signature(thing).parameters) | {"return"}, set(hints), name)


class Lock(unittest.TestCase):
    """The interpreter goes on while the native half works."""

    def goes_on(self, work: Callable[[], object]) -> bool:
        """Whether this thread comes to run while another is inside of `work`.

        Threads are never made to take turns here: this one runs only where the other lets go of the interpreter."""
        state = []

        def other() -> None:
            state.append("began")
            work()
            state.append("ended")

        interval = sys.getswitchinterval()
        sys.setswitchinterval(1000)
        try:
            thread = threading.Thread(target=other)
            thread.start()
            seen = list(state)
        finally:
            sys.setswitchinterval(interval)
        thread.join()
        self.assertEqual(state, ["began", "ended"])
        return seen == ["began"]

    def test_work_in_python_alone_does_not_let_go(self) -> None:
        self.assertFalse(self.goes_on(lambda: sum(range(1000))))

    def test_rendering_lets_go(self) -> None:
        self.assertTrue(self.goes_on(lambda: portray.render(GLASS, (200, 150), samples=16, threads=1)))

    def test_the_toolkit_lets_go(self) -> None:
        noise = numpy.random.Generator(numpy.random.PCG64(3)).integers(0, 256, (600, 800, 3), numpy.uint8)
        self.assertTrue(self.goes_on(lambda: portray.quantize(noise, threads=1)))
        self.assertTrue(self.goes_on(lambda: portray.composite("over", noise, noise, at=(1, 1))))
        self.assertTrue(self.goes_on(lambda: portray.equalize(noise, tiles=8)))


class Interrupted(Exception):
    pass


class Signals(unittest.TestCase):
    """A render of years ends when a signal comes."""

    def setUp(self) -> None:
        def raised(number: int, frame: types.FrameType | None) -> None:
            # Not before the render has begun.
            if frame is not None and frame.f_code is portray.render.__code__:
                raise Interrupted

        before = signal.signal(signal.SIGINT, raised)
        self.addCleanup(signal.signal, signal.SIGINT, before)

    def interrupted(self, **how: typing.Any) -> int:
        """Renders until another thread, which makes pictures meanwhile, has sent a signal; how many it has made."""
        ended = threading.Event()
        made = []

        def other() -> None:
            while not ended.is_set():
                made.append(portray.render(GLASS, (8, 6), threads=1).rgb)
                os.kill(os.getpid(), signal.SIGINT)

        thread = threading.Thread(target=other)
        thread.start()
        try:
            with self.assertRaises(Interrupted):
                portray.render(GLASS, (256, 256), **how)
        finally:
            ended.set()
            thread.join()
        return len(made)

    def test_every_way_of_sampling_can_be_interrupted(self) -> None:
        for how in (
            {"samples": 65536, "aa": "stochastic"},
            {"samples": 65536, "aa": "none"},
            {"error": 1e-6},
            {"seconds": 1e6},
            {"samples": 65536, "certify": True},
        ):
            with self.subTest(how):
                self.assertGreater(self.interrupted(**how), 0)
        # And the next one is as any other.
        self.assertEqual(portray.render(GLASS, (8, 6)).rgb.shape, (6, 8, 3))


class Documents(InFolder):
    def test_the_examples_of_the_documentation_hold(self) -> None:
        tests = 0
        for name in ("portray", "portray._scene"):
            found = doctest.testmod(sys.modules[name])
            self.assertEqual(found.failed, 0, name)
            tests += found.attempted
        self.assertGreater(tests, 4)

    def test_the_page_of_the_task_holds(self) -> None:
        os.symlink(ROOT / "scenes", "scenes")
        page = (ROOT / "docs/tasks/python.md").read_text()
        blocks = re.findall(r"^```python\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
        self.assertGreater(len(blocks), 3)
        names: dict[str, object] = {}
        for block in blocks:
            exec(compile(block, "docs/tasks/python.md", "exec"), names)

    def test_the_example_runs(self) -> None:
        os.environ["MPLBACKEND"] = "Agg"
        os.environ["PORTRAY_EXAMPLE_SIZE"] = "48x36"
        self.addCleanup(os.environ.pop, "PORTRAY_EXAMPLE_SIZE")
        names = runpy.run_path(str(ROOT / "python/examples/error_against_time.py"))
        rows = names["rows"]
        self.assertGreater(len(rows), 3)
        for _, seconds, _, error in rows:
            self.assertGreater(seconds, 0)
            self.assertGreater(error, 0)
        self.assertLess(rows[-1][-1], rows[0][-1], "more samples, less error")
