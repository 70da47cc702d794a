"""A page of plumb view --export in a headless browser, from its file: hands, sliders, and the bits of plumb run."""
import os
import shutil
import subprocess

from browser_test import View, check_hands, check_replay, check_sliders, check_time, read_arguments, skip, start_browser


class ExportedView(View):
    """A page that runs worlds itself."""

    def __init__(self, browser, file):
        self.browser = browser
        browser.get("file://" + os.path.abspath(file))
        self.until("window.plumb?.frame?.frame > 3", "frames come")

    def __exit__(self, *_):
        self.browser.get("about:blank")


def export(plumb, folder, *arguments):
    run = subprocess.run([plumb, "view", "--export", folder, *arguments], capture_output=True, text=True, check=False)
    if run.returncode == 2 and "--target plumb_view_wasm" in run.stderr:
        skip(run.stderr.strip())
    assert run.returncode == 0, run.stderr
    return run.stdout.strip()


def check_error(plumb, folder):
    """A program without the WebAssembly says how to build it."""
    alone = os.path.join(folder, "alone", "bin")
    os.makedirs(alone, exist_ok=True)
    copy = shutil.copy(plumb, alone)
    run = subprocess.run([copy, "view", "--export", os.path.join(folder, "none")], capture_output=True, text=True,
                         check=False)
    assert run.returncode == 2 and "cmake --build build-wasm --target plumb_view_wasm" in run.stderr, run.stderr


def check_alone(view):
    """The page loads nothing, and says what it runs on."""
    loaded = view.js("return performance.getEntriesByType('resource').map(e => e.name)")
    assert all(name.startswith(("data:", "blob:")) for name in loaded), loaded
    assert "one thread" in view.js("return document.getElementById('panel').textContent")


def main():
    plumb, folder = read_arguments()
    page = export(plumb, os.path.join(folder, "page"))
    browser = start_browser(False, 1280, 720)
    try:
        with ExportedView(browser, page) as view:
            assert len(view.js("return window.plumb.frame.sides")) == 3
            check_alone(view)
            check_hands(view)
            view.click("reset")
            view.pause(False)
            check_sliders(view)
            check_time(view)
            file = check_replay(view, plumb, folder)
            browser.save_screenshot(os.path.join(folder, "exported.png"))
            assert not view.severe(), view.severe()
        with ExportedView(browser, export(plumb, os.path.join(folder, "replay"), "--replay", file)) as view:
            view.until("!window.plumb.frame.playing", "the replay ends")
            view.until("document.getElementById('note').textContent.includes('same bits')", "bits are the same")
            assert not view.severe(), view.severe()
        with ExportedView(browser, export(plumb, os.path.join(folder, "figure"), "humanoid")) as view:
            view.js("window.plumb.page.send(window.plumb.requests.set('gravity', 5))")
            view.goes_on()
            check_replay(view, plumb, folder)
            assert not view.severe(), view.severe()
    finally:
        browser.quit()
    check_error(plumb, folder)


main()
