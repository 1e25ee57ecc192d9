"""The info of a vectorized step: a dict that makes its arrays when it is first used."""

from collections.abc import Callable
from typing import Any

from . import _native


class StepInfo(dict[str, Any]):
    """A dict that gets its contents from ``details`` at the first access: most loops use none of the arrays, and making them
    takes longer than the rest of a vectorized step. The caller sets ``details`` right after construction (an ``__init__`` would
    take time).

    Copies, also by pickle, are plain dicts.
    """

    __slots__ = ("details",)
    details: _native.StepDetails | None

    def _fill(self) -> None:
        details, self.details = self.details, None
        if details is not None:
            dict.update(self, details.info())

    def __reduce_ex__(self, protocol: Any) -> tuple[Any, ...]:
        return dict, (dict(self),)


def _filling(name: str) -> Callable[..., Any]:
    method = getattr(dict, name)

    def filled(self: StepInfo, *arguments: Any, **options: Any) -> Any:
        if self.details is not None:
            self._fill()
        return method(self, *arguments, **options)

    filled.__name__ = name
    return filled


# All methods of a dict that read or change its contents. Because `__iter__` is overridden, `dict(info)` and `{**info}` call
# `keys`, instead of copying the empty dict directly.
_METHODS = (
    "__contains__ __delitem__ __eq__ __getitem__ __ior__ __iter__ __len__ __ne__ __or__ __repr__ __reversed__ __ror__ "
    "__setitem__ clear copy get items keys pop popitem setdefault update values"
)
for _name in _METHODS.split():
    setattr(StepInfo, _name, _filling(_name))
