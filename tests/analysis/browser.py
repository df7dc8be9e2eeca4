"""A page in headless Chromium, driven by Selenium (Debian: python3-selenium, chromium-driver)."""

import base64
import json
import os
import shutil
import tempfile

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
except ImportError:
    webdriver = None

DRIVER = shutil.which("chromedriver") if webdriver else None
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync", "--hide-scrollbars",
         "--disable-dev-shm-usage")


class Browser:
    """One browser with one page. Use as `with Browser() as page:`."""

    def __init__(self):
        self.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        options = webdriver.ChromeOptions()
        for flag in (*FLAGS, f"--user-data-dir={self.folder.name}"):
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.driver = webdriver.Chrome(service=Service(DRIVER), options=options)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.driver.quit()
        self.folder.cleanup()

    def send(self, method, **parameters):
        """Runs a command of the DevTools protocol; returns its result."""
        return self.driver.execute_cdp_cmd(method, parameters)

    def open(self, path, width=1280, height=900, dark=False, still=True, phone=False):
        """Shows a file; waits until its scripts have run and its frames are drawn."""
        for log in ("browser", "performance"):    # empties the logs
            self.driver.get_log(log)
        self.send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=phone)
        features = {"prefers-color-scheme": "dark" if dark else "light",
                    "prefers-reduced-motion": "reduce" if still else "no-preference"}
        self.send("Emulation.setEmulatedMedia", features=[{"name": n, "value": v} for n, v in features.items()])
        self.driver.get(f"file://{os.path.abspath(path)}")
        self.settle()

    def settle(self):
        """Waits until changes are drawn."""
        self.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(null))))")

    def run(self, code):
        """The value of a JavaScript expression in the page; of a promise, its resolved value."""
        found = self.send("Runtime.evaluate", expression=code, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in found:
            raise RuntimeError(found["exceptionDetails"].get("exception", found["exceptionDetails"]).get("description"))
        return found["result"].get("value")

    def complaints(self):
        """Errors, warnings and uncaught exceptions on the page's console."""
        return [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]

    def requests(self):
        """Addresses that the page requested, except data URLs."""
        events = [json.loads(entry["message"])["message"] for entry in self.driver.get_log("performance")]
        urls = [event["params"]["request"]["url"] for event in events if event["method"] == "Network.requestWillBeSent"]
        return [url for url in urls if not url.startswith("data:")]

    def box(self, selector):
        """(left, top, width, height) of an element, scrolled into view."""
        return self.run(f"(() => {{ const found = document.querySelector({json.dumps(selector)});"
                        "found.scrollIntoView({block: 'center', behavior: 'instant'});"
                        "const b = found.getBoundingClientRect();"
                        "return [b.left, b.top, b.width, b.height]; })()")

    def move(self, x, y):
        self.send("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
        self.settle()

    def tap(self, x, y):
        """Touches and lifts; the browser makes the mouse's events of it, as on a phone."""
        self.send("Emulation.setTouchEmulationEnabled", enabled=True)
        self.send("Input.dispatchTouchEvent", type="touchStart", touchPoints=[{"x": x, "y": y}])
        self.send("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
        self.send("Emulation.setTouchEmulationEnabled", enabled=False)
        self.settle()

    def click(self, selector):
        left, top, width, height = self.box(selector)
        for kind in ("mousePressed", "mouseReleased"):
            self.send("Input.dispatchMouseEvent", type=kind, x=left + width / 2, y=top + height / 2, button="left",
                      clickCount=1)
        self.settle()

    def key(self, name):
        for kind in ("keyDown", "keyUp"):
            self.send("Input.dispatchKeyEvent", type=kind, key=name)
        self.settle()

    def paper(self):
        """The printed page: the bytes of a PDF."""
        printed = self.send("Page.printToPDF", printBackground=True, preferCSSPageSize=True)
        return base64.b64decode(printed["data"])
