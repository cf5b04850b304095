"""Renders: values worked out by hand, and the same samples as `portray` has."""

from __future__ import annotations

import json
from pathlib import Path

import numpy
import portray

from programs import GLASS, BesidePrograms, InFolder

SPHERE = "object is rgb (1, 1, 1) sphere  camera at (0, 0, 9)  ambient intensity 1  background rgb (0, 0, 1)"
ALL = ("rgb", "coverage", "depth", "normal", "objects")


class ByHand(InFolder):
    def test_a_sphere_of_radius_1_is_8_from_a_camera_at_9(self) -> None:
        found = portray.render(SPHERE, (33, 31), channels=ALL, aa="none")
        middle, corner = (15, 16), (0, 0)
        self.assertEqual(found.rgb.shape, (31, 33, 3))
        self.assertEqual(found.rgb.dtype, numpy.uint8)
        self.assertEqual(found.rgb[middle].tolist(), [255, 255, 255])
        self.assertEqual(found.coverage[middle], 255)
        self.assertEqual(found.depth[middle], 8)
        numpy.testing.assert_allclose(found.normal[middle], [0, 0, 1], atol=1e-12)
        self.assertEqual(found.objects[middle], 1)
        self.assertEqual(found.coverage[corner], 0)
        self.assertEqual(found.depth[corner], numpy.finfo(numpy.float32).max)
        self.assertEqual(found.normal[corner].tolist(), [0, 0, 0])
        self.assertEqual(found.objects[corner], 0)
        self.assertEqual(found.size, (33, 31))
        self.assertEqual(found.pixels.shape, (31, 33, 4))

    def test_without_coverage_the_background_is_painted_in(self) -> None:
        found = portray.render(SPHERE, (33, 31))
        self.assertIsNone(found.coverage)
        self.assertIsNone(found.depth)
        self.assertEqual(found.rgb[0, 0].tolist(), [0, 0, 255])

    def test_floating_point_is_linear_and_not_clamped(self) -> None:
        bright = SPHERE.replace("intensity 1", "intensity 0.25")
        light = portray.render(bright, (33, 31), dtype=numpy.float32, aa="none").rgb
        self.assertEqual(light.dtype, numpy.float32)
        self.assertEqual(light[15, 16].tolist(), [0.25, 0.25, 0.25])
        display = portray.render(bright, (33, 31), aa="none").rgb
        # sRGB: 1.055 · 0.25^(1 / 2.4) - 0.055 = 0.5371.
        self.assertEqual(display[15, 16].tolist(), [137, 137, 137])

    def test_the_error_is_known_where_samples_are_drawn_by_lot(self) -> None:
        reached = portray.render(GLASS, (40, 30), error=1.5)
        self.assertLessEqual(reached.estimated_error, 1.5)
        self.assertGreater(reached.estimated_error, 0)
        self.assertEqual(reached.statistics["ending"], "done")
        self.assertIsNone(portray.render(GLASS, (40, 30)).estimated_error)

    def test_a_picture_of_some_seconds_is_a_picture(self) -> None:
        found = portray.render(GLASS, (16, 12), seconds=0.05)
        self.assertEqual(found.rgb.shape, (12, 16, 3))

    def test_definitions_replace_numbers(self) -> None:
        scene = "let far = 9  " + SPHERE.replace("(0, 0, 9)", "(0, 0, far)")
        near = portray.render(scene, (9, 9), channels=("depth",), definitions={"far": 5})
        self.assertEqual(near.depth[4, 4], 4)
        self.assertIsNone(near.light)

    def test_warnings_are_told(self) -> None:
        found = portray.render("camera at (0, 0, 9)", (4, 4))
        self.assertEqual(found.rgb.shape, (4, 4, 3))
        self.assertEqual(found.diagnostics[-1].severity, "warning")
        self.assertIn("no objects", found.diagnostics[-1].message)


class AsPortray(BesidePrograms):
    def test_every_way_of_sampling_gives_the_same_bytes(self) -> None:
        for options in (
            {},
            {"samples": 4},
            {"aa": "none", "samples": 9, "filter": "tent"},
            {"aa": "adaptive", "samples": 4},
            {"aa": "stochastic", "samples": 3, "seed": 7, "filter": "mitchell"},
            {"aa": "stochastic"},
            {"error": 4.0},
            {"certify": True},
            {"certify": True, "samples": 4},
            {"depth": 2, "min_weight": 0.1, "glossy": True, "dither_output": True},
        ):
            with self.subTest(options):
                words = []
                for name, value in options.items():
                    words.append("--" + name.replace("_", "-"))
                    words.extend([] if value is True else [value])
                self.run_program("portray", GLASS, "--size", "64x48", "-o", "a.png", *words)
                found = portray.render(GLASS, (64, 48), **options)
                numpy.testing.assert_array_equal(found.rgb, portray.read("a.png").rgb)
                portray.write("b.png", found)
                self.assertEqual(Path("a.png").read_bytes(), Path("b.png").read_bytes())

    def test_channels_are_those_of_open_exr(self) -> None:
        names = "rgb,cvg,depth,normal,object"
        self.run_program("portray", GLASS, "--size", "64x48", "-o", "a.exr", "--channels", names)
        written = portray.read("a.exr")
        found = portray.render(GLASS, (64, 48), channels=ALL, dtype="float32")
        for name in ("light", "coverage", "depth", "normal", "objects"):
            numpy.testing.assert_array_equal(getattr(found, name), getattr(written, name), name)

    def test_straight_coverage_is_that_of_png(self) -> None:
        self.run_program("portray", GLASS, "--size", "64x48", "-o", "a.png", "--channels", "rgb,cvg")
        found = portray.render(GLASS, (64, 48), channels=("rgb", "coverage"))
        numpy.testing.assert_array_equal(found.pixels, portray.read("a.png").pixels)

    def test_a_compiled_scene_gives_the_same_picture(self) -> None:
        text = portray.compile(GLASS).scene
        self.assertEqual(text, self.run_program("prcomp", GLASS, "-o", "-"))
        Path("glass.prc").write_text(text)
        expected = portray.render(GLASS, (32, 24)).rgb
        for source in (text, "glass.prc", Path("glass.prc"), GLASS.read_text()):
            numpy.testing.assert_array_equal(portray.render(source, (32, 24)).rgb, expected)

    def test_figures_are_those_of_stats(self) -> None:
        self.run_program("portray", GLASS, "--size", "64x48", "-o", "a.png", "--stats", "a.json")
        expected = json.loads(Path("a.json").read_text())
        found = portray.render(GLASS, (64, 48)).statistics
        for name in set(expected) - {"trace_seconds", "depth_cut_bound", "weight_cut_bound"}:
            # The mean number of samples is printed in three decimals.
            self.assertAlmostEqual(found[name], expected[name], 3, name)
        self.assertEqual(set(found) - {"ending"}, set(expected))

    def test_figures_of_proofs_are_those_of_stats(self) -> None:
        self.run_program("portray", GLASS, "--size", "64x48", "-o", "a.png", "--certify", "--stats", "a.json")
        expected = json.loads(Path("a.json").read_text())
        found = portray.render(GLASS, (64, 48), certify=True).statistics
        for name in ("certain_share", "undecided_share", "undecided_bound", "tiles_given_up_share"):
            self.assertAlmostEqual(found[name], expected[name], 3, name)
        self.assertGreater(found["certain_share"], 0.5)

    def test_threads_change_nothing(self) -> None:
        one, two = (portray.render(GLASS, (48, 36), error=3, threads=n).rgb for n in (1, 2))
        numpy.testing.assert_array_equal(one, two)
