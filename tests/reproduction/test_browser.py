"""The report of `undula reproduce` in a real browser, wide and narrow.

Needs Debian's packages chromium and chromium-driver.
"""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from small_catalogue import small_catalogue
from undula.app.cli import main

BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        BROWSER is None or DRIVER is None,
        reason="no browser to look with: apt-get install chromium chromium-driver",
    ),
]
SIZES = {"desktop": (1400, 1000), "phone": (390, 844)}
#: Seconds for a page of some megabytes on a busy machine.
PATIENCE = 60.0


@pytest.fixture(scope="module")
def report(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("reproduced")
    catalogue = small_catalogue(folder / "catalogue")
    out = folder / "report"
    assert main(["reproduce", "--catalogue", str(catalogue), "--out", str(out)]) == 0
    return out / "index.html"


@pytest.fixture(params=SIZES.values(), ids=SIZES)
def browser(request) -> Iterator:
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = BROWSER
    width, height = request.param
    # As root, without a graphics card, and without a large shared memory, as in a container.
    for word in ("headless=new", "no-sandbox", "disable-gpu", "disable-dev-shm-usage"):
        options.add_argument(f"--{word}")
    # Windows are not made as narrow as a phone: its screen is emulated.
    metrics = {"width": width, "height": height, "pixelRatio": 1.0, "mobile": width < 600}
    options.add_experimental_option("mobileEmulation", {"deviceMetrics": metrics})
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    driver.set_page_load_timeout(PATIENCE)
    driver.set_script_timeout(PATIENCE)
    yield driver
    driver.quit()


def opened(browser, report: Path) -> None:
    browser.get(report.as_uri())


def test_all_figures_are_there_and_nothing_is_complained_of(browser, report) -> None:
    opened(browser, report)
    widths = browser.execute_script("return [...document.images].map((one) => one.naturalWidth)")
    assert len(widths) == 3
    assert min(widths) > 100
    # The film has been opened far enough to know how long it is.
    length = browser.execute_async_script(
        """const film = document.querySelector("video"), done = arguments[0];
        const tell = () => done(film.duration);
        if (film.readyState > 0) tell(); else film.addEventListener("loadedmetadata", tell);
        film.addEventListener("error", () => done(0));"""
    )
    assert length > 0.1
    assert [entry["message"] for entry in browser.get_log("browser")] == []


def test_nothing_sticks_out_to_the_side(browser, report) -> None:
    opened(browser, report)
    wide, seen = browser.execute_script(
        "return [document.documentElement.scrollWidth, window.innerWidth]"
    )
    assert wide <= seen


def test_rows_can_be_chosen_by_verdict(browser, report) -> None:
    from selenium.webdriver.common.by import By

    opened(browser, report)
    rows = browser.find_elements(By.CSS_SELECTOR, "#claims + table tbody tr")
    assert sum(row.is_displayed() for row in rows) == 4
    button = browser.find_element(By.CSS_SELECTOR, '[data-show="confirmed within a stated range"]')
    button.click()
    assert sum(row.is_displayed() for row in rows) == 1
    button.click()
    assert sum(row.is_displayed() for row in rows) == 4


def test_a_diagram_opens_to_be_pointed_at(browser, report) -> None:
    from selenium.webdriver.common.by import By
    from selenium.webdriver.support.ui import WebDriverWait

    opened(browser, report)
    browser.execute_script("document.querySelector('[data-page]').click()")
    wait = WebDriverWait(browser, PATIENCE)
    frame = wait.until(lambda page: page.find_elements(By.TAG_NAME, "iframe"))[0]
    browser.switch_to.frame(frame)
    wait.until(lambda page: page.find_elements(By.CSS_SELECTOR, "#diagram .point"))
    browser.switch_to.default_content()
    assert [entry["message"] for entry in browser.get_log("browser")] == []
