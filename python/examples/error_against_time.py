# %% [markdown]
# # Error against time
#
# How far off is a picture after so many seconds? Samples drawn by lot tell it of themselves: `estimated_error` is the root
# of the mean square error in display steps of 1/255. Here it stands beside the true error, against a picture of many
# samples. Every cell runs by itself in an editor that knows `# %%`, and the whole file as a program.

# %%
import os
from pathlib import Path

import numpy
import portray

scene = Path(__file__).resolve().parents[2] / "scenes/gallery/gears.sdl"
columns, rows_of_pixels = map(int, os.environ.get("PORTRAY_EXAMPLE_SIZE", "96x72").split("x"))
size = (columns, rows_of_pixels)

# %% [markdown]
# The truth: 1024 samples a pixel, as a display encodes light (sRGB), but not rounded.


# %%
def display(linear: numpy.ndarray) -> numpy.ndarray:
    """Linear light as display values in steps of 1/255."""
    light = linear.astype(float)
    low, high = 12.92 * light, 1.055 * numpy.maximum(light, 1e-9) ** (1 / 2.4) - 0.055
    return 255 * numpy.where(light <= 0.0031308, low, high)


truth = display(portray.render(scene, size, samples=1024, aa="stochastic", seed=1, dtype="float32").rgb)

# %% [markdown]
# One row for each number of samples: seconds, the estimate, the true error.

# %%
rows = []
for samples in (2, 4, 8, 16, 32, 64):
    made = portray.render(scene, size, samples=samples, aa="stochastic", dtype="float32")
    error = float(numpy.sqrt(numpy.mean((display(made.rgb) - truth) ** 2)))
    rows.append((samples, made.statistics["trace_seconds"], made.estimated_error, error))

print("samples   seconds  estimated     error")
for samples, seconds, estimated, error in rows:
    print(f"{samples:7} {seconds:9.4f} {estimated:10.3f} {error:9.3f}")

# %% [markdown]
# Both fall as a straight line where both axes are logarithmic.

# %%
try:
    from matplotlib import pyplot
except ImportError:
    print("matplotlib is not installed: there is no plot")
else:
    seconds = [row[1] for row in rows]
    figure, axes = pyplot.subplots(figsize=(6, 4))
    axes.loglog(seconds, [row[3] for row in rows], "o-", label="error")
    axes.loglog(seconds, [row[2] for row in rows], "s--", label="estimated")
    axes.set(xlabel="seconds", ylabel="root mean square error, display steps", title=scene.stem)
    axes.grid(which="both", alpha=0.3)
    axes.legend()
    figure.tight_layout()
    figure.savefig("error-against-time.png", dpi=150)
    print("wrote error-against-time.png")
