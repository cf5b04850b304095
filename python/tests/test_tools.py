"""The toolkit: values by hand, and the same bytes as the programs give."""

from __future__ import annotations

from pathlib import Path

import numpy
import portray

from programs import BesidePrograms, InFolder


def photograph(rows: int, columns: int) -> numpy.ndarray:
    """A smooth picture with some noise of a fixed sequence."""
    noise = numpy.random.Generator(numpy.random.PCG64(1)).integers(0, 16, (rows, columns, 3))
    across, down = numpy.meshgrid(numpy.arange(columns), numpy.arange(rows))
    slope = numpy.dstack((230 * across // columns, 230 * down // rows, 100 + 100 * (across + down) // (columns + rows)))
    return (slope + noise).astype(numpy.uint8)


class ByHand(InFolder):
    def test_two_colours_are_a_palette_of_two(self) -> None:
        picture = numpy.zeros((2, 3, 3), numpy.uint8)
        picture[1] = (10, 20, 30)
        indices, palette = portray.quantize(picture)
        self.assertEqual(sorted(palette.tolist()), [[0, 0, 0], [10, 20, 30]])
        numpy.testing.assert_array_equal(palette[indices], picture)

    def test_coverage_is_kept_in_the_palette_or_put_over_a_matte(self) -> None:
        picture = numpy.array([[[255, 0, 0, 255], [0, 0, 0, 0]]], numpy.uint8)
        indices, palette = portray.quantize(picture)
        numpy.testing.assert_array_equal(palette[indices], picture)
        indices, palette = portray.quantize(picture, matte=(0, 0, 1))
        self.assertEqual(palette[indices].tolist(), [[[255, 0, 0], [0, 0, 255]]])

    def test_a_pane_lets_three_fifths_through(self) -> None:
        pane = numpy.array([[[0.4, 0.4]]], numpy.float32)
        behind = numpy.array([[0.5]], numpy.float32)
        found = portray.composite("over", pane, behind)
        numpy.testing.assert_allclose(found, [[0.4 + 0.6 * 0.5]], rtol=1e-6)
        self.assertEqual(found.shape, (1, 1), "it covers all")

    def test_the_canvas_takes_both_in(self) -> None:
        a, b = numpy.full((2, 2), 200, numpy.uint8), numpy.full((3, 3), 100, numpy.uint8)
        found = portray.composite("over", a, b, at=(-1, 2))
        self.assertEqual(found.shape, (4, 4, 2), "4 columns from -1, 4 rows")
        self.assertEqual(found[2, 0].tolist(), [200, 255])
        self.assertEqual(found[0, 1].tolist(), [100, 255])
        self.assertEqual(found[0, 0].tolist(), [0, 0])

    def test_views_are_taken_as_they_are_seen(self) -> None:
        picture = photograph(12, 10)
        wide = numpy.zeros((12, 20, 3), numpy.uint8)
        wide[:, ::2] = picture
        frozen = numpy.array(picture)
        frozen.flags.writeable = False
        views = {
            "every other column": wide[:, ::2],
            "upside down twice": numpy.array(picture[::-1])[::-1],
            "columns first": numpy.asfortranarray(picture),
            "channels apart": numpy.moveaxis(numpy.array(numpy.moveaxis(picture, 2, 0)), 0, 2),
            "read only": frozen,
        }
        for name, view in views.items():
            with self.subTest(name):
                for function in (
                    lambda image: portray.quantize(image, 8)[0],
                    lambda image: portray.composite("over", image, picture, at=(3, 4)),
                    lambda image: portray.tone(image, "gamma", 1.5),
                ):
                    numpy.testing.assert_array_equal(function(view), function(picture))
                portray.write("view.png", view)
                numpy.testing.assert_array_equal(portray.read("view.png").rgb, picture)

    def test_brightness_adds(self) -> None:
        grey = numpy.array([[0, 51], [102, 255]], numpy.uint8)
        self.assertEqual(portray.tone(grey, "brightness", 0.2).tolist(), [[51, 102], [153, 255]])

    def test_an_equalised_tone_is_the_share_of_those_up_to_it(self) -> None:
        grey = numpy.array([[100, 110, 120, 130]], numpy.uint8)
        # A quarter, a half, three quarters and all of 255.
        self.assertEqual(portray.equalize(grey).tolist(), [[64, 128, 191, 255]])

    def test_arrays_of_any_layout_are_read(self) -> None:
        picture = photograph(12, 20)
        expected = portray.tone(picture, "gamma", 2)
        backward = picture[:, ::-1]
        numpy.testing.assert_array_equal(portray.tone(backward, "gamma", 2), expected[:, ::-1])
        numpy.testing.assert_array_equal(portray.tone(numpy.asfortranarray(picture), "gamma", 2), expected)
        before = picture.copy()
        picture.flags.writeable = False
        numpy.testing.assert_array_equal(portray.tone(picture, "gamma", 2), expected)
        numpy.testing.assert_array_equal(picture, before)

    def test_what_is_written_is_read_again(self) -> None:
        wide = photograph(6, 9).astype(numpy.uint16) * 257
        linear = numpy.random.Generator(numpy.random.PCG64(2)).random((6, 9, 4), numpy.float32)
        for name, picture in (
            ("grey.png", photograph(6, 9)[:, :, 0]),
            ("a.png", photograph(6, 9)),
            ("wide.png", wide),
            ("straight.png", numpy.dstack((photograph(6, 9), photograph(6, 9)[:, :, 0] | 1))),
            ("a.exr", linear),
            ("a", linear),
            ("b.idf", photograph(6, 9)),
            ("a.ppm", photograph(6, 9)),
        ):
            with self.subTest(name):
                portray.write(name, picture, at=(0, 0))
                found = portray.read(name)
                numpy.testing.assert_array_equal(found.pixels, picture)
                self.assertEqual(found.pixels.dtype, picture.dtype)

    def test_measured_channels_and_places_come_back(self) -> None:
        picture = photograph(4, 5)
        depth = numpy.arange(20, dtype=numpy.float32).reshape(4, 5)
        normal = numpy.dstack((depth, -depth, depth + 1))
        objects = numpy.arange(20, dtype=numpy.uint16).reshape(4, 5)
        for name in ("a", "a.exr"):
            portray.write(name, picture, depth=depth, normal=normal, objects=objects, at=(3, -2), rle=True)
            found = portray.read(name)
            self.assertEqual(found.at, (3, -2))
            numpy.testing.assert_array_equal(found.depth, depth)
            numpy.testing.assert_array_equal(found.normal, normal)
            numpy.testing.assert_array_equal(found.objects, objects)

    def test_indexed_pictures_keep_their_indices(self) -> None:
        indices, palette = portray.quantize(photograph(8, 9), 16)
        for name in ("a.png", "a.gif", "a.idf"):
            portray.write(name, indices, palette=palette)
            found = portray.read(name)
            numpy.testing.assert_array_equal(found.indices, indices)
            numpy.testing.assert_array_equal(found.palette[: len(palette)], palette)
            numpy.testing.assert_array_equal(found.rgb, palette[indices])
            portray.write("again.png", found)
            numpy.testing.assert_array_equal(portray.read("again.png").indices, indices)


class AsPrograms(BesidePrograms):
    def setUp(self) -> None:
        super().setUp()
        self.picture = photograph(60, 80)
        portray.write("a.png", self.picture)

    def test_quantising_gives_the_bytes_of_iencode(self) -> None:
        kept = numpy.array([[0, 0, 0], [255, 255, 255]], numpy.uint8)
        for words, options in (
            ((), {}),
            (("-n", 16), {"colours": 16}),
            (("-n", 16, "--method", "heckbert"), {"colours": 16, "method": "heckbert"}),
            (("-n", 40, "--method", "fast", "--metric", "oklab"), {"colours": 40, "method": "fast", "metric": "oklab"}),
            (("-n", 16, "--dither", "floyd-steinberg"), {"colours": 16, "dither": "floyd-steinberg"}),
            (("-n", 8, "--dither", "blue-noise", "--strength", 0.5),
             {"colours": 8, "dither": "blue-noise", "strength": 0.5}),
            (("-n", 9, "--keep", "#000000,#ffffff"), {"colours": 9, "keep": kept}),
        ):
            with self.subTest(words):
                self.run_program("iencode", "a.png", *words, "-q", "-o", "b.png")
                indices, palette = portray.quantize(self.picture, **options)
                portray.write("c.png", indices, palette=palette)
                self.assertEqual(Path("b.png").read_bytes(), Path("c.png").read_bytes())
                found = portray.quantize(self.picture, palette=palette, dither=options.get("dither", "none"),
                                         metric=options.get("metric", "rgb"), strength=options.get("strength"))
                numpy.testing.assert_array_equal(found.palette, palette)

    def test_as_few_colours_as_reach_an_error_are_those_of_ilut(self) -> None:
        self.run_program("ilut", "a.png", "--max-error", 12, "-q", "-o", "few.lut")
        self.run_program("iencode", "a.png", "--lut", "few.lut", "-q", "-o", "b.png")
        palette = portray.quantize(self.picture, max_error=12).palette
        self.assertLess(len(palette), 256)
        numpy.testing.assert_array_equal(palette, portray.read("b.png").palette)

    def test_compositing_gives_the_bytes_of_icomp(self) -> None:
        pane = numpy.dstack((self.picture[::-1], self.picture[:, :, 1]))
        portray.write("pane.png", pane)
        for operator in "clear a b over rover in rin out rout atop ratop xor plus".split():
            for words, options in (((), {}), (("--at", "7,-9", "--stored"), {"at": (7, -9), "stored": True})):
                with self.subTest((operator, words)):
                    self.run_program("icomp", operator, "pane.png", "a.png", *words, "-o", "b.png")
                    found = portray.composite(operator, pane, self.picture, **options)
                    numpy.testing.assert_array_equal(found, portray.read("b.png").pixels)
        for operator in ("darken", "dissolve"):
            self.run_program("icomp", operator, 0.3, "pane.png", "-o", "b.png")
            found = portray.composite(operator, pane, factor=0.3)
            numpy.testing.assert_array_equal(found, portray.read("b.png").pixels)

    def test_tones_have_the_bytes_of_ieq(self) -> None:
        for words, work in (
            (("equalize",), lambda p: portray.equalize(p)),
            (("equalize", "--per-channel"), lambda p: portray.equalize(p, per_channel=True)),
            (("clahe", "--tiles", 4, "--clip", 0.02), lambda p: portray.equalize(p, tiles=4, clip=0.02)),
            (("gamma", 2.2), lambda p: portray.tone(p, "gamma", 2.2)),
            (("levels", 0.1, 0.8), lambda p: portray.tone(p, "levels", 0.1, 0.8)),
            (("contrast", 1.5), lambda p: portray.tone(p, "contrast", 1.5)),
            (("saturation", 0.4), lambda p: portray.tone(p, "saturation", 0.4)),
            (("hue", 30), lambda p: portray.tone(p, "hue", 30)),
        ):
            with self.subTest(words):
                self.run_program("ieq", words[0], *words[1:], "a.png", "-o", "b.png")
                numpy.testing.assert_array_equal(work(self.picture), portray.read("b.png").rgb)

    def test_threads_change_nothing(self) -> None:
        for work in (
            lambda n: portray.quantize(self.picture, 32, threads=n).indices,
            lambda n: portray.composite("over", self.picture, self.picture, at=(3, 4), threads=n),
            lambda n: portray.equalize(self.picture, tiles=4, threads=n),
        ):
            numpy.testing.assert_array_equal(work(1), work(2))
