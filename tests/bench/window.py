"""Presses with a real mouse in a window on a virtual display, and measures how long its frames take."""

import contextlib
import json
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

WIDTH, HEIGHT = 1280, 720
WARM_UP_SECONDS, STROKE_SECONDS = 4, 15
REACH_DOWN, REACH_SIDEWAYS = 90, 60  # of the stroke, in pixels


@contextlib.contextmanager
def virtual_display():
    """Starts Xvfb. Yields the display's name."""
    reading, writing = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(writing), "-screen", "0", f"{WIDTH + 20}x{HEIGHT + 40}x24",
                               "-nolisten", "tcp"], pass_fds=[writing], stderr=subprocess.DEVNULL)
    os.close(writing)
    try:
        with os.fdopen(reading) as number:
            line = number.readline().strip()
        if not line:
            raise RuntimeError("Xvfb did not start")
        yield ":" + line
    finally:
        server.terminate()
        server.wait()


def hands(display, *words):
    done = subprocess.run(["xdotool", *(str(word) for word in words)], env={**os.environ, "DISPLAY": display},
                          stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    return done.returncode == 0


def press_and_stir(display, start, seconds):
    """Presses the button at a pixel and moves for `seconds`; the tool pushes down and stirs."""
    x, y = start
    hands(display, "mousemove", x, y - 20, "mousemove", x, y)
    time.sleep(0.5)
    if not hands(display, "mousedown", 1):
        raise RuntimeError("xdotool cannot press a button")
    began = time.monotonic()
    step = 0
    while time.monotonic() - began < seconds:
        down = min(REACH_DOWN, 6 * step)
        sideways = REACH_SIDEWAYS * (step % 40 / 20 - 1 if step % 80 < 40 else 1 - step % 40 / 20) / 2
        hands(display, "mousemove", round(x + sideways), round(y + down))
        time.sleep(0.05)
        step += 1
    hands(display, "mouseup", 1)


def wait_for_window(display, window):
    for _ in range(200):
        if window.poll() is not None:
            raise RuntimeError(f"the window ended with {window.returncode}")
        if hands(display, "search", "--onlyvisible", "--name", "Spoonbill", "windowfocus"):
            return
        time.sleep(0.1)
    raise RuntimeError("no window appeared")


def rate_of_hud(folder, began, ended):
    """Returns the mean of the frames per second that Mesa's counter wrote, one value for each half second."""
    file = Path(folder) / "fps"
    values = [float(line) for line in file.read_text().split()] if file.exists() else []
    values = values[-round((ended - began) / 0.5) - 1:-1]
    return sum(values) / len(values) if values else None


def drawn_while_pressing(program, model, quality, start, seconds=STROKE_SECONDS):
    """Opens `model` in the window of `program` and presses. Returns the frames per second (None if Mesa does not draw),
    the sorted times of the frames in ms and the fraction of frames in which the tool touched. A program without a log of
    its frames has no times."""
    with virtual_display() as display, tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "frames.log"
        copy = Path(folder) / "model.json"
        shutil.copyfile(model, copy)
        environment = {**os.environ, "DISPLAY": display, "SPOONBILL_FRAME_LOG": str(log), "XDG_STATE_HOME": folder,
                       "GALLIUM_HUD": "simple,fps", "GALLIUM_HUD_VISIBLE": "false", "GALLIUM_HUD_PERIOD": "0.5",
                       "GALLIUM_HUD_DUMP_DIR": folder}
        options = ["--quality", quality] if quality else []
        window = subprocess.Popen([str(program), "edit", str(copy), "--size", f"{WIDTH}x{HEIGHT}", *options],
                                  env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            wait_for_window(display, window)
            time.sleep(WARM_UP_SECONDS)
            logged = len(log.read_text().splitlines()) if log.exists() else 0
            began = time.monotonic()
            press_and_stir(display, start, seconds)
            ended = time.monotonic()
            time.sleep(0.7)
            if window.poll() is not None:
                raise RuntimeError(f"the window ended with {window.returncode}")
            lines = log.read_text().splitlines()[logged:-1] if log.exists() else []
            rate = rate_of_hud(folder, began, ended)
        finally:
            window.kill()
            window.wait()
    frames = [json.loads(line) for line in lines]
    return {"frames_per_second": rate,
            "frame_ms": sorted(frame["last_frame_ms"] for frame in frames if "last_frame_ms" in frame),
            "touching": sum(frame["in_stroke"] for frame in frames) / max(1, len(frames))}


def quantile(values, fraction):
    if not values:
        raise RuntimeError("the window logged no frames")
    return values[min(len(values) - 1, int(fraction * len(values)))]
