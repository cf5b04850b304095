"""What is wrong is said: the place, what was found, what was expected; and nothing panics."""

from __future__ import annotations

import json
import pickle
import subprocess
from pathlib import Path

import numpy
import portray

from programs import BesidePrograms, InFolder

GREY = numpy.zeros((4, 5), numpy.uint8)
COLOUR = numpy.zeros((4, 5, 3), numpy.uint8)


class Scenes(InFolder):
    def test_mistakes_are_structured(self) -> None:
        compiled = portray.compile("camera at (0, 0, 5)\nobject is glas\nclass glass is cone")
        self.assertIsNone(compiled.scene)
        (error,) = compiled.errors
        self.assertEqual(error.severity, "error")
        self.assertEqual(error.message, "unknown class `glas`")
        self.assertEqual((error.file, error.line, error.column), ("<text>", 2, 11))
        self.assertEqual((error.end_line, error.end_column), (2, 15))
        self.assertTrue(str(error).startswith("<text>:2:11: error: unknown class `glas`"))

    def test_a_render_raises_them(self) -> None:
        with self.assertRaises(portray.SceneError) as caught:
            portray.render("object is glas", (4, 4))
        self.assertIsInstance(caught.exception, ValueError)
        self.assertIn("object is glas\n  |           ^^^^", str(caught.exception))
        (error,) = [d for d in caught.exception.diagnostics if d.severity == "error"]
        self.assertEqual(error.line, 1)
        again = pickle.loads(pickle.dumps(caught.exception))
        self.assertEqual(again.diagnostics, caught.exception.diagnostics)

    def test_a_scene_that_cannot_be_loaded_is_one_with_mistakes(self) -> None:
        with self.assertRaisesRegex(portray.SceneError, "camera") as caught:
            portray.render("object is sphere", (4, 4))
        self.assertIsNone(caught.exception.diagnostics[-1].line)

    def test_a_picture_that_is_none_is_pointed_at(self) -> None:
        Path("bark.png").write_bytes(b"no picture")
        scene = 'camera at (0, 0, 9)\nobject is paint image ("bark.png") sphere'
        errors = portray.compile(scene).errors
        self.assertEqual([(found.line, found.column) for found in errors], [(2, 24)])
        self.assertIn("cannot show the picture", errors[0].message)

    def test_files_that_are_not_there_are_errors_of_the_system(self) -> None:
        for scene in ("none.sdl", Path("none.sdl"), "none.prc"):
            with self.assertRaisesRegex(FileNotFoundError, "none"):
                portray.render(scene)
            with self.assertRaisesRegex(FileNotFoundError, "none"):
                portray.compile(scene)
        with self.assertRaisesRegex(FileNotFoundError, "none.png"):
            portray.read("none.png")
        with self.assertRaises(OSError):
            portray.write("none/a.png", COLOUR)

    def test_damaged_files_are_wrong_values(self) -> None:
        Path("a.prc").write_text("portray scene 999\n")
        Path("a.png").write_bytes(b"\x89PNG\r\n\x1a\n")
        with self.assertRaisesRegex(ValueError, "a.prc"):
            portray.render("a.prc")
        with self.assertRaisesRegex(ValueError, "a.png"):
            portray.read("a.png")
        with self.assertRaisesRegex(ValueError, "ends in"):
            portray.write("a.doc", COLOUR)


class Arguments(InFolder):
    def test_wrong_arguments_say_what_was_expected(self) -> None:
        scene = "object is sphere camera at (0, 0, 5)"
        render, quantize, composite, tone = portray.render, portray.quantize, portray.composite, portray.tone
        cases = (
            (TypeError, "scene: expected a str or a path, found int", lambda: render(7)),
            (TypeError, "size: expected two whole numbers, found 64", lambda: render(scene, 64)),
            (TypeError, "expected a whole number, found float", lambda: render(scene, (64.5, 64))),
            (ValueError, "size: expected a whole number from 1 to 65535, found 0", lambda: render(scene, (0, 4))),
            (ValueError, "size: .* found -3", lambda: render(scene, (4, -3))),
            (ValueError, "size: .* found a larger one", lambda: render(scene, (4, 10**30))),
            (ValueError, "pixels", lambda: render(scene, (65535, 65535))),
            (ValueError, "samples: found 3: .* square grid, .* nearest is 4", lambda: render(scene, samples=3)),
            (ValueError, "samples: found 8: .* power of 4, .* nearest is 4", lambda: render(scene, samples=8, aa="adaptive")),
            (ValueError, "samples: .* found 0", lambda: render(scene, samples=0, aa="stochastic")),
            (ValueError, "expected one of samples, error and seconds", lambda: render(scene, samples=4, error=1)),
            (ValueError, "error: expected a number above 0", lambda: render(scene, error=-1)),
            (ValueError, "error: .* found NaN", lambda: render(scene, error=float("nan"))),
            (ValueError, "seconds: .* found inf", lambda: render(scene, seconds=float("inf"))),
            (ValueError, "error: .* by lot", lambda: render(scene, error=1, aa="none")),
            (ValueError, "certify with aa: pixels", lambda: render(scene, certify=True, aa="adaptive")),
            (ValueError, "certify with filter: proofs", lambda: render(scene, certify=True, filter="tent")),
            (ValueError, "certify with error: parts", lambda: render(scene, certify=True, error=1)),
            (ValueError, "cannot be certified|nothing can be certified",
             lambda: render(scene + " aperture 8", certify=True)),
            (ValueError, "aa: expected one of none, adaptive, stochastic", lambda: render(scene, aa="all")),
            (ValueError, "filter: expected one of box", lambda: render(scene, filter="gauss")),
            (ValueError, "channels: expected one of rgb", lambda: render(scene, channels=["red"])),
            (TypeError, "channels: expected a sequence", lambda: render(scene, channels="rgb")),
            (ValueError, "dtype: expected uint8 or float32, found int16", lambda: render(scene, dtype="int16")),
            (ValueError, "depth: .* to 10000, found 10001", lambda: render(scene, depth=10001)),
            (ValueError, "min_weight", lambda: render(scene, min_weight=2)),
            (ValueError, "seed", lambda: render(scene, seed=-1)),
            (ValueError, "threads: .* from 1 to 1024, found 0", lambda: render(scene, threads=0)),
            (ValueError, "dither_output", lambda: render(scene, dtype="float32", dither_output=True)),
            (ValueError, "definitions", lambda: render(scene, definitions={"a b": 1})),
            (ValueError, "definitions", lambda: render(scene, definitions={"a": float("inf")})),
            (TypeError, "image: expected a numpy array of uint8, uint16 or float32, found list", lambda: quantize([1])),
            (TypeError, "image: .* found float64", lambda: quantize(COLOUR.astype(float))),
            (TypeError, "image: .* found >u2", lambda: quantize(COLOUR.astype(">u2"))),
            (ValueError, r"image: .* found \[4, 5, 5\]", lambda: quantize(numpy.zeros((4, 5, 5), numpy.uint8))),
            (ValueError, r"image: .* found \[4\]", lambda: quantize(GREY[:, 0])),
            (ValueError, "image: 0 x 0 pixels", lambda: quantize(GREY[:0, :0])),
            (ValueError, "not a number", lambda: quantize(numpy.full((2, 2), numpy.nan, numpy.float32))),
            (ValueError, "colours: .* to 256, found 257", lambda: quantize(COLOUR, 257)),
            (ValueError, "colours: .* found 0", lambda: quantize(COLOUR, 0)),
            (ValueError, "method: expected one of heckbert, fast, best", lambda: quantize(COLOUR, method="worst")),
            (ValueError, "metric", lambda: quantize(COLOUR, metric="hsv")),
            (ValueError, "dither", lambda: quantize(COLOUR, dither="bayer")),
            (ValueError, "strength: belongs to a dither", lambda: quantize(COLOUR, strength=0.5)),
            (ValueError, "strength: .* found 2", lambda: quantize(COLOUR, dither="blue-noise", strength=2)),
            (ValueError, r"palette: .* found shape \[4, 5\]", lambda: quantize(COLOUR, palette=GREY)),
            (TypeError, "palette: .* found float64", lambda: quantize(COLOUR, palette=numpy.zeros((2, 3)))),
            (ValueError, "2 colours to keep", lambda: quantize(COLOUR, 1, keep=GREY[:2, :3])),
            (ValueError, "max_error", lambda: quantize(COLOUR, max_error=-1)),
            (ValueError, "matte", lambda: quantize(COLOUR, matte=(0, 0, 2))),
            (ValueError, "operator: expected one of clear, a, b, over", lambda: composite("under", COLOUR, COLOUR)),
            (ValueError, "over: expected two pictures, found one", lambda: composite("over", COLOUR)),
            (ValueError, "darken: expected one picture, found two", lambda: composite("darken", COLOUR, COLOUR)),
            (ValueError, "darken: expected a factor", lambda: composite("darken", COLOUR)),
            (ValueError, "factor: over takes none", lambda: composite("over", COLOUR, COLOUR, factor=1)),
            (ValueError, "factor: .* found -1", lambda: composite("darken", COLOUR, factor=-1)),
            (ValueError, "opaque: .* float32", lambda: composite("opaque", COLOUR, factor=0)),
            (ValueError, "at: ", lambda: composite("over", COLOUR, COLOUR, at=(2**40, 0))),
            (MemoryError, "canvas of 16777216 x 16777220", lambda: composite("over", COLOUR, COLOUR, at=(2**24 - 5, 2**24))),
            (ValueError, "sharpen: no operation .* equalize", lambda: tone(COLOUR, "sharpen")),
            (ValueError, "gamma: expected 1 to 1 numbers, found 0", lambda: tone(COLOUR, "gamma")),
            (ValueError, "gamma: expected G from 0.01 to 100, found -1", lambda: tone(COLOUR, "gamma", -1)),
            (ValueError, "operation: .* found \"histogram\"", lambda: tone(COLOUR, "histogram")),
            (ValueError, "per_channel", lambda: tone(COLOUR, "gamma", 2, per_channel=True)),
            (ValueError, "tiles", lambda: portray.equalize(COLOUR, tiles=0)),
            (ValueError, "depth: holds measured values", lambda: portray.write("a.png", COLOUR, depth=GREY)),
            (ValueError, r"normal: .* \(4, 5, 3\), found \[4, 5\]", lambda: portray.write("a.exr", COLOUR, normal=GREY)),
            (ValueError, "index 7, expected one of 2 colours",
             lambda: portray.write("a.png", GREY + 7, palette=COLOUR[:2, 0])),
            (TypeError, "image: expected indices", lambda: portray.write("a.png", COLOUR, palette=COLOUR[0])),
        )
        for kind, message, wrong in cases:
            with self.subTest(message):
                with self.assertRaisesRegex(kind, message):
                    wrong()
        self.assertEqual(list(self.folder.iterdir()), [], "nothing was written")

    def test_an_error_leaves_the_old_file(self) -> None:
        portray.write("a.png", COLOUR)
        before = Path("a.png").read_bytes()
        with self.assertRaises(ValueError):
            portray.write("a.png", numpy.full((2, 2), numpy.nan, numpy.float32))
        self.assertEqual(Path("a.png").read_bytes(), before)

    def test_an_image_without_light_says_what_it_has(self) -> None:
        with self.assertRaisesRegex(ValueError, "no light; it has depth"):
            _ = portray.Image(depth=GREY).rgb


class AsPrcomp(BesidePrograms):
    def test_diagnostics_are_those_of_the_compiler(self) -> None:
        Path("a.sdl").write_text("object is glas\nobjekt is sphere\nlight point at (0, 0)\n")
        done = subprocess.run(
            ["prcomp", "a.sdl", "--check", "--message-format", "json"], capture_output=True, text=True, check=False
        )
        expected = [json.loads(line) for line in done.stderr.splitlines()]
        found = portray.compile("a.sdl").diagnostics
        self.assertGreaterEqual(len(found), 2)
        self.assertEqual([d.message for d in found], [e["message"] for e in expected])
        self.assertEqual([d.line for d in found], [e["line"] for e in expected])
