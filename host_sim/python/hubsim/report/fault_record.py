# SPDX-License-Identifier: Apache-2.0
"""The record of a controller's first fault, as a section of the page."""

import base64

from hubsim.report.markup import Markup, element
from hubsim.report.reading import FaultRecord


def section(record: FaultRecord, place: int) -> Markup:
    """Show what a record says, and its picture, which keeps its own colours."""
    coded = base64.b64encode(record.picture).decode("ascii")
    picture = element(
        "img",
        src=f"data:image/svg+xml;base64,{coded}",
        alt="phase currents, bus voltage, torque and wheel speed around the fault",
    )
    return element(
        "section",
        element("h2", f"Black box: {record.reason}"),
        element("p", f"Recorded by the controller, read from {record.name}.", class_="soft"),
        element("ul", *[element("li", line) for line in record.lines]),
        element("figure", picture, class_="record"),
        id=f"record-{place}",
    )
