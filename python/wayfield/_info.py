"""The info of a vectorized step: a dict that makes its arrays when they are first asked for."""

from collections.abc import Callable
from typing import Any

from . import _native


class StepInfo(dict[str, Any]):
    """A dict whose first contents are those of ``details``, which is set right after it is made. (An ``__init__`` would take
    time.) They are made at the first access, since most loops look at none of the arrays, and making them takes longer than
    the rest of a vector call.

    A copy and a pickled one are plain dicts.
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


# All methods of a dict that read or change its contents. With `__iter__` among them, `dict(info)` and `{**info}` use `keys`.
_METHODS = (
    "__contains__ __delitem__ __eq__ __getitem__ __ior__ __iter__ __len__ __ne__ __or__ __repr__ __reversed__ __ror__ "
    "__setitem__ clear copy get items keys pop popitem setdefault update values"
)
for _name in _METHODS.split():
    setattr(StepInfo, _name, _filling(_name))
