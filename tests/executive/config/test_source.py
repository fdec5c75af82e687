import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from executive.config.source import MAX_BYTES, read, read_text
from executive.core.errors import ConfigError


def refused(text):
    with pytest.raises(ConfigError) as caught:
        read_text(text, "f.yaml")
    return str(caught.value)


def test_every_value_and_key_knows_its_place():
    source = read_text("a: 1\nb:\n  - x\n  - {c: 30 mm}\n", "f.yaml")
    assert source.data == {"a": 1, "b": ["x", {"c": "30 mm"}]}
    assert (source.at(("b", 1, "c")).line, source.at(("b", 1, "c")).column) == (4, 9)
    assert (source.key_at(("b", 1, "c")).line, source.key_at(("b", 1, "c")).column) == (4, 6)
    assert source.at(("b", 7, "missing")).line == 3


def test_scalars_follow_the_core_schema_of_yaml_1_2():
    text = "[yes, on, no, 12:30:00, 2020-01-01, 0o17, 017, 1_000, 1e3, .5, true, ~, '5', 0x1F]"
    assert read_text(text, "f").data == [
        "yes", "on", "no", "12:30:00", "2020-01-01", 15, 17, "1_000", 1000.0, 0.5, True, None, "5", 31
    ]  # fmt: skip


def test_several_problems_are_told_at_once():
    source = read_text("a: 1\na: 2\nb: !!python/object:os.system x\nc: .nan\n? [1]\n: 2\n", "f.yaml")
    assert [str(p) for p in source.problems] == [
        "f.yaml:2:1: got the key 'a' a second time, expected it once (first in line 1)",
        "f.yaml:3:4: got the tag !!python/object:os.system, expected plain YAML without tags",
        "f.yaml:4:4: got .nan, expected a finite number",
        "f.yaml:5:3: got a collection as a key, expected text",
    ]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "f.yaml:1:1: got an empty file, expected a YAML document"),
        ("# nothing\n", "f.yaml:1:1: got an empty file, expected a YAML document"),
        ("a: 1\n---\nb: 2\n", "f.yaml:2:1: got a second document, expected one document in a file"),
        ("a: \x00", "f.yaml:1:4: got the character '\\x00', which YAML does not allow"),
        ("[" * 200, "f.yaml:1:65: nested deeper than 64 levels"),
    ],
)
def test_what_is_no_document_is_refused_with_its_place(text, message):
    assert refused(text) == message


def test_a_yaml_bomb_is_refused_before_it_expands():
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 12)]
    assert "aliases that expand to more than" in refused("\n".join(lines))


def test_an_alias_inside_itself_is_refused():
    assert "aliases that expand" in refused("&a [*a]")


def test_a_missing_file_a_folder_and_a_huge_one_are_located(tmp_path):
    huge = tmp_path / "huge.yaml"
    huge.write_bytes(b"#" * (MAX_BYTES + 1))
    for path, message in [
        (tmp_path / "none.yaml", "no such file"),
        (tmp_path, "got a folder, expected a YAML file"),
        (huge, "file exceeds 1 MB, the limit for YAML input"),
    ]:
        with pytest.raises(ConfigError) as caught:
            read(path)
        assert str(caught.value) == f"{path}:1:1: {message}"


def test_bytes_that_are_not_utf_8_are_located(tmp_path):
    path = tmp_path / "latin.yaml"
    path.write_bytes(b"a: 1\nb: \xe9t\xe9\n")
    with pytest.raises(ConfigError) as caught:
        read(path)
    assert str(caught.value) == f"{path}:2:4: got the byte 0xe9, expected UTF-8 text"


yaml_like = st.lists(
    st.sampled_from([*list("abc:- {}[]&*!|>'\"\n\t#%@,?~0.\\"), "\n  ", "---", "&a", "*a", "!!", "<<: "]),
    max_size=40,
).map("".join)


@settings(max_examples=300, deadline=None)
@given(st.one_of(st.text(max_size=60), yaml_like))
def test_any_text_is_data_or_a_config_error(text):
    try:
        source = read_text(text, "f")
    except ConfigError:
        return
    assert source.at(()) is not None


@settings(max_examples=100, deadline=None)
@given(st.binary(max_size=60))
def test_any_bytes_are_data_or_a_config_error(tmp_path_factory, content):
    path = tmp_path_factory.mktemp("fuzz") / "f.yaml"
    path.write_bytes(content)
    try:
        read(path)
    except ConfigError as error:
        assert error.problems
