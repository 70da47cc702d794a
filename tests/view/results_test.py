"""The page of measurements in a headless browser: its replays play, stills need no script, a phone's width is enough."""
import os
import subprocess
import time

from browser_test import read_arguments, start_browser, take_picture, wait_until

# The sum of a canvas's bytes: it changes where what is drawn does.
DRAWN = """const c = document.querySelector("figure.replay canvas");
return c.getContext("2d").getImageData(0, 0, c.width, c.height).data.reduce((sum, byte) => sum + byte, 0);"""
PRESS = "document.querySelector('figure.replay button').click();"
CLOCK = "return parseFloat(document.querySelector('figure.replay output').textContent)"


def until(browser, condition, what):
    wait_until(condition, what, lambda: "the clock says " + str(browser.execute_script(CLOCK)))


def check_replay(browser, folder, name):
    browser.execute_script("document.querySelector('figure.replay').scrollIntoView()")
    until(browser, lambda: browser.execute_script(CLOCK) > 0.3, "the replay has begun by itself")
    before = browser.execute_script(DRAWN)
    until(browser, lambda: browser.execute_script(DRAWN) != before, "what is drawn moves")
    take_picture(browser, os.path.join(folder, name))
    stopped = browser.execute_script(PRESS + CLOCK)
    time.sleep(0.2)
    assert browser.execute_script(CLOCK) == stopped, "it pauses"
    browser.execute_script("const t = document.querySelector('figure.replay input'); t.value = t.max;"
                           "t.dispatchEvent(new Event('input'))")
    assert browser.execute_script(CLOCK) > 1, "it can be moved to its end"
    # In one script, for the replay goes on between two, for as long as the machine lets this test wait.
    assert browser.execute_script(PRESS + CLOCK) == 0, "Play begins again after the end"
    until(browser, lambda: browser.execute_script(CLOCK) > 0, "it plays on")


def check_alone(browser):
    loaded = browser.execute_script("return performance.getEntriesByType('resource').map(e => e.name)")
    assert not loaded, loaded
    severe = [entry["message"] for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    assert not severe, severe


def check_without_scripts(address, folder):
    browser = start_browser(False, 1280, 720)
    try:
        browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
        browser.get(address)
        # Selenium's own scripts run all the same.
        assert browser.execute_script("return document.querySelector('canvas, .time') === null")
        still = browser.execute_script("return document.querySelector('figure svg').getBoundingClientRect().height")
        assert still > 50, "the stills are there"
        take_picture(browser, os.path.join(folder, "results-no-scripts.png"))
    finally:
        browser.quit()


def main():
    plumb, folder = read_arguments()
    out = os.path.join(folder, "results")
    # Headings and tables of falls are the widest.
    subprocess.run([plumb, "fall", "--quick", "--quiet", "--out", out], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([plumb, "humanoid", "--ball-speed", "20", "--quiet", "--out", out], check=True)
    address = "file://" + os.path.abspath(os.path.join(out, "index.html"))
    for dark in [False, True]:
        for width, height in [(1280, 720), (390, 844)]:
            browser = start_browser(dark, width, height)
            try:
                browser.get(address)
                assert not browser.execute_script("return document.documentElement.scrollWidth > innerWidth"), width
                check_replay(browser, folder, f"results-{'dark' if dark else 'light'}-{width}.png")
                check_alone(browser)
            finally:
                browser.quit()
    check_without_scripts(address, folder)


main()
