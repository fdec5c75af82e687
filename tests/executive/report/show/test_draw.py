import xml.etree.ElementTree as ET

import pytest

from executive.report.show import FORMATS, draw
from executive.report.show.boxes import boxes
from executive.report.show.layout import lay_out
from executive.tree.load import load_tree_text

TREE = load_tree_text(
    """
tree: drawn
doc: Something to look at. And more.
ports: {route: {type: Route}, pose: {type: PoseEstimate}}
root:
  recover:
    attempts: 3
    child:
      sequence:
        - wait: {duration: 20 min}
          while: "{pose.tilt} < 25 deg"
        - for_each: {in: "{route}", as: segment, child: {always: {detail: 'a "quote"'}}}
        - parallel: {policy: one, children: [{inverter: always}, {timeout: {after: 3 s, child: always}}]}
"""
)
FIX = load_tree_text("tree: fix\ndoc: Mend it.\nroot: {sequence: [{wait: {duration: 1 s}}, always]}\n")
STRATEGIES = {"fix": FIX, "other": FIX}


@pytest.mark.parametrize("form", FORMATS)
def test_every_format_shows_every_node_and_strategy(form):
    drawing = draw(TREE, form, STRATEGIES)
    if form == "png":
        assert drawing.startswith(b"\x89PNG")
        return
    for word in ("wait", "for_each", "always", "fix", "20 min"):
        assert word in drawing


def test_the_svg_is_well_formed_and_self_contained():
    drawing = draw(TREE, "svg", STRATEGIES)
    root = ET.fromstring(drawing)
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    assert "href" not in drawing
    assert drawing.count("stroke-dasharray") == 3 * len(STRATEGIES)


def test_boxes_do_not_overlap_and_fit_the_drawing():
    root = boxes(TREE, STRATEGIES)
    width, height = lay_out(root)
    placed = list(root.walk())
    for index, box in enumerate(placed):
        assert box.x >= 0
        assert box.y >= 0
        assert box.x + box.width <= width
        assert box.y + box.height <= height
        for other in placed[:index]:
            apart_x = box.x >= other.x + other.width or other.x >= box.x + box.width
            apart_y = box.y >= other.y + other.height or other.y >= box.y + box.height
            assert apart_x or apart_y, (box.path, other.path)


def test_outcomes_colour_their_nodes_and_fade_the_rest():
    plain = draw(TREE, "svg")
    coloured = draw(TREE, "svg", outcomes={"drawn/recover/sequence/wait": "failure"})
    assert "#fbe2df" not in plain
    assert coloured.count("#fbe2df") == 1
    assert "#e6f4f0" not in coloured


def test_groot_gets_valid_xml_with_a_model_of_every_port():
    root = ET.fromstring(draw(TREE, "groot", STRATEGIES))
    assert root.attrib == {"BTCPP_format": "4", "main_tree_to_execute": "drawn"}
    trees = {tree.get("ID"): tree for tree in root.findall("BehaviorTree")}
    assert set(trees) == {"drawn", "fix"}
    assert all(len(tree) == 1 for tree in trees.values())
    assert trees["drawn"].find(".//wait").attrib == {"duration": "20 min", "_while": "{pose.tilt} < 25 deg"}
    assert trees["drawn"].find(".//Timeout").get("msec") == "3000"
    model = root.find("TreeNodesModel")
    (port,) = model.findall("./Action[@ID='wait']/input_port")
    assert (port.get("name"), port.get("type"), port.text) == ("duration", "duration", "how long to wait")


def test_mermaid_escapes_what_it_would_take_for_syntax():
    drawing = draw(TREE, "mermaid")
    assert "{" not in drawing
    assert "#123;route#125;" in drawing


def test_the_outline_reads_top_to_bottom():
    lines = draw(TREE, "unicode", {"fix": FIX}).splitlines()
    assert lines[0] == "⌂ drawn"
    assert lines[1] == "└─ ✚ recover  attempts: 3"
    assert lines[3] == "   │  ├─ wait  duration: 20 min  [while: {pose.tilt} < 25 deg]"
    assert "   └┄ ✚ fix" in lines
