import pytest
import yaml

from executive.cli import invoke
from executive.cli.importing import import_file, tree_text, write_trees
from executive.config.find import names
from executive.core.errors import ConfigError
from executive.report.show import draw
from executive.tree.load import load_tree, load_tree_text
from executive.tree.strategies import load_strategies, strategy_trees

FOREIGN = """\
<root BTCPP_format="4" main_tree_to_execute="Main Tree">
  <BehaviorTree ID="Main Tree">
    <ReactiveSequence name="main">
      <Action ID="BatteryOK" threshold="0.2"/>
      <RetryUntilSuccessful num_attempts="3">
        <SubTree ID="GoThere" goal="{place}" _autoremap="true"/>
      </RetryUntilSuccessful>
      <Timeout msec="1500" _skipIf="stopped || !enabled"><Sleep msec="1000"/></Timeout>
      <KeepRunningUntilFailure><AlwaysSuccess/></KeepRunningUntilFailure>
      <Repeat num_cycles="-1"><Inverter><AlwaysFailure/></Inverter></Repeat>
      <Parallel success_count="1"><AlwaysSuccess/><Fallback><AlwaysSuccess/></Fallback></Parallel>
    </ReactiveSequence>
  </BehaviorTree>
  <BehaviorTree ID="GoThere">
    <Sequence>
      <turn_towards target="{goal}" pose="{pose}" segment="{segment}"/>
      <Delay delay_msec="500"><localise quality="precise" pose="{pose}"/></Delay>
    </Sequence>
  </BehaviorTree>
</root>
"""
BAD = """\
<root BTCPP_format="4">
  <BehaviorTree ID="bad">
    <Sequence>
      <Script code="a := 3"/>
      <wait duration="5"/>
      <localise qualty="precise"
                pose="{pose}"/>
      <Parallel success_count="2" failure_count="2"><localise/><localise/><localise/></Parallel>
      <Inverter/>
      <wait duration="5 s" _onSuccess="x = 1" _failureIf="a = 3"/>
      <SubTree ID="nowhere"/>
      <Strange><wait duration="1 s"/></Strange>
    </Sequence>
  </BehaviorTree>
</root>
"""
WHOLE = """
tree: whole
doc: Every kind of node. And more.
ports:
  route: {type: Route, doc: the way}
  pose: {type: PoseEstimate, direction: inout}
  near: {type: length, default: 30 mm}
  eager: {type: flag, default: true}
  how_often: {type: integer, default: 3}
root:
  recover:
    attempts: 3
    child:
      sequence:
        memory: false
        children:
          - {wait: {duration: 20 min}, while: "{pose.tilt} < 25 deg", name: rest}
          - for_each: {in: "{route}", as: segment, child: {always: {detail: 'a "quote" <&>', success: false}}}
          - parallel: {policy: one, children: [{inverter: always}, {timeout: {after: 3 s, child: always}}]}
          - {retry: {attempts: 2, child: {force_failure: always}}, skip_if: "{eager} and {how_often} > 2"}
          - repeat: {child: {force_success: {always: {}}}}
          - {repeat: {times: 2, child: {selector: [always, always]}}, failure_if: "not {eager}"}
          - loop: [{arrived: {target: "{target}", pose: "{pose}", within: "{near}"}}, always]
          - turn_towards: {target: "{target}", pose: "{pose}"}
"""


def imported(tmp_path, text):
    path = tmp_path / "trees.xml"
    path.write_text(text)
    return import_file(path)


def problems(tmp_path, text):
    with pytest.raises(ConfigError) as caught:
        imported(tmp_path, text)
    return [(p.line, p.column, p.message) for p in caught.value.problems]


def everything(tree):
    """A tree in full, for comparison: its drawing and all that the drawing leaves out."""
    return draw(tree), tree.ports, tree.doc, tree.values, draw(tree, "groot")


@pytest.mark.parametrize("name", names("trees"))
def test_what_export_wrote_of_a_shipped_tree_comes_back(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    before = load_tree(name)
    found = imported(tmp_path, draw(before, "groot"))
    write_trees(found.trees, tmp_path / "trees")
    assert everything(load_tree(tmp_path / "trees" / f"{name}.yaml")) == everything(before)


def test_the_trees_of_strategies_come_back_too(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    strategies = strategy_trees(load_strategies())
    found = imported(tmp_path, draw(load_tree("navigate"), "groot", strategies))
    for path in write_trees(found.trees, tmp_path / "trees"):
        load_tree(path)
    for tree in strategies.values():
        assert everything(load_tree(tmp_path / "trees" / f"{tree.name}.yaml")) == everything(tree)


def test_every_kind_of_node_goes_there_and_back(tmp_path):
    text = WHOLE.replace("  pose:", "  target: {type: Point}\n  pose:")
    before = load_tree_text(text)
    found = imported(tmp_path, draw(before, "groot"))
    assert everything(load_tree_text(tree_text(found.trees["whole"]))) == everything(before)


def test_a_foreign_tree_becomes_trees_of_ours(tmp_path):
    found = imported(tmp_path, FOREIGN)
    assert list(found.trees) == ["Main_Tree", "GoThere"]
    main = found.trees["Main_Tree"]
    children = main["root"]["sequence"]["children"]
    assert main["root"]["sequence"]["memory"] is False
    assert children[0] == {"BatteryOK": {"threshold": "0.2"}}
    given = {"goal": "{place}", "segment": "{segment}"}
    assert children[1]["retry"] == {"attempts": 3, "child": {"GoThere": given}}
    assert children[2] == {
        "timeout": {"after": "1.5 s", "child": {"wait": {"duration": "1 s"}}},
        "skip_if": "{stopped} or not {enabled}",
    }
    assert children[3] == {"repeat": {"child": {"always": {"success": True}}}}
    assert children[4] == {"repeat": {"child": {"inverter": {"child": {"always": {"success": False}}}}}}
    assert children[5]["parallel"]["policy"] == "one"


def test_ports_are_found_from_what_the_nodes_do_with_values(tmp_path):
    trees = imported(tmp_path, FOREIGN).trees
    assert trees["GoThere"]["ports"] == {
        "goal": {"type": "Point", "direction": "in"},
        "segment": {"type": "Segment", "direction": "in"},
    }
    assert trees["Main_Tree"]["ports"] == {
        "place": {"type": "Point", "direction": "in"},
        "segment": {"type": "Segment", "direction": "in"},
        "stopped": {"type": "flag", "direction": "in"},
        "enabled": {"type": "flag", "direction": "in"},
    }


def test_what_is_known_passes_the_check_as_written(tmp_path):
    load_tree_text(tree_text(imported(tmp_path, FOREIGN).trees["GoThere"]))


def test_what_reads_differently_here_is_told_at_its_place(tmp_path):
    notes = [(n.line, n.message) for n in imported(tmp_path, FOREIGN).notes]
    assert notes == [
        (2, 'the tree "Main Tree" is called Main_Tree here'),
        (
            3,
            "ReactiveSequence becomes a sequence without memory: it starts anew at every tick",
        ),
        (4, 'the leaf "BatteryOK" is not known here: kept by name, to be written'),
    ]


def test_every_problem_is_told_at_once_at_its_place_in_the_xml(tmp_path):
    assert problems(tmp_path, BAD) == [
        (4, 7, "got Script, a script; set values by ports of leaves; expected a node that our trees have"),
        (8, 32, 'got success_count "2", expected 1 or all children'),
        (8, 50, 'got failure_count "2", expected 1: ours fails as soon as one child does'),
        (10, 40, "got _onSuccess, a script run afterwards; expected none: set values by ports"),
        (10, 59, 'got the script "a = 3", which a guard cannot say; expected a condition such as a < 3'),
        (12, 7, 'got the unknown control or decorator "Strange"'),
    ]
    known = BAD.replace("<Strange>", "<Inverter>").replace("</Strange>", "</Inverter>")
    assert [found for found in problems(tmp_path, known) if found[0] in (5, 6, 9, 11)] == [
        (5, 23, "got '5' without a unit, expected a duration such as '36 s'"),
        (
            6,
            25,
            'got the unknown port "qualty" of localise, expected patience, quality, pose, segment, budget, '
            'position, yaw or settle; did you mean "quality"?',
        ),
        (9, 7, "inverter needs one child"),
        (11, 20, 'got the unknown node "nowhere", expected a node or a tree'),
    ]


@pytest.mark.parametrize(
    ("script", "guard"),
    [
        ("battery < 20 && !stopped", "{battery} < 20 and not {stopped}"),
        ("mode == 'a' || !(x >= 2)", "{mode} == 'a' or not ({x} >= 2)"),
        ("abs(x) != y", "abs({x}) != {y}"),
        ("{x} < 30 mm", "{x} < 30 mm"),
        ("x.y > 1", "{x.y} > 1"),
        ("true", "true"),
    ],
)
def test_conditions_become_guards(script, guard, tmp_path):
    from executive.cli.importing.scripts import expression

    assert expression(script) == guard


@pytest.mark.parametrize("script", ["x := 3", "a = 1; b = 2", "a ? b : c", "a & 1", "@global > 1", "", "a +"])
def test_scripts_that_no_guard_can_say_are_problems(script, tmp_path):
    text = FOREIGN.replace("stopped || !enabled", script.replace("&", "&amp;"))
    assert any("which a guard cannot say" in message for _, _, message in problems(tmp_path, text))


@pytest.mark.parametrize(
    ("text", "place", "message"),
    [
        ("", (1, 1), "not well-formed XML: no element found"),
        ("<root BTCPP_format='4'>\n<oops></root>", (2, 9), "not well-formed XML: mismatched tag"),
        ("<root BTCPP_format='3'/>", (1, 21), 'got the BTCPP_format "3", expected 4'),
        ("<roof/>", (1, 1), "got <roof>, expected <root> of BehaviorTree.CPP"),
        ("<root BTCPP_format='4'/>", (1, 1), "got no tree, expected a <BehaviorTree>"),
        (
            "<!DOCTYPE r [<!ENTITY a 'b'>]><root BTCPP_format='4'/>",
            (1, 25),
            "got an entity declaration, expected plain XML without",
        ),
        (
            "<root BTCPP_format='4'><include path='x.xml'/></root>",
            (1, 24),
            "got an include, expected one file; import the included file as well",
        ),
    ],
)
def test_a_file_that_is_no_such_thing_is_told_so(text, place, message, tmp_path):
    assert (*place, message) in problems(tmp_path, text)


def test_a_tree_inside_itself_is_a_problem(tmp_path):
    text = FOREIGN.replace('<localise quality="precise" pose="{pose}"/>', '<SubTree ID="GoThere"/>')
    assert any("a tree inside itself" in message for _, _, message in problems(tmp_path, text))


def test_the_command_writes_a_file_a_tree_or_nothing(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "good.xml").write_text(FOREIGN)
    (tmp_path / "bad.xml").write_text(BAD)
    assert invoke(["import", "bad.xml", "-o", "out"]) == 2
    assert not (tmp_path / "out").exists()
    assert invoke(["import", "good.xml", "-o", "out"]) == 0
    told = capsys.readouterr()
    assert told.out.splitlines() == ["out/Main_Tree.yaml", "out/GoThere.yaml"]
    assert 'good.xml:4:7: note: the leaf "BatteryOK"' in told.err
    assert yaml.safe_load((tmp_path / "out" / "GoThere.yaml").read_text())["tree"] == "GoThere"


def test_a_file_in_the_way_is_replaced_only_when_asked(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "good.xml").write_text(FOREIGN)
    (tmp_path / "trees").mkdir()
    mine = tmp_path / "trees" / "GoThere.yaml"
    mine.write_text("mine\n")
    assert invoke(["import", "good.xml"]) == 2
    assert "trees/GoThere.yaml:1:1: got a file that is there already" in capsys.readouterr().err
    assert [p.name for p in (tmp_path / "trees").iterdir()] == ["GoThere.yaml"]
    assert mine.read_text() == "mine\n"
    assert invoke(["import", "good.xml", "--force"]) == 0
    assert "turn_towards" in mine.read_text()
