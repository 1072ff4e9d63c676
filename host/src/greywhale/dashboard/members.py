"""The members who share a board: pages, one of which may drive, and a verb that may run for one."""

from __future__ import annotations

from dataclasses import dataclass, field

from greywhale.dashboard.client import Client
from greywhale.dashboard.outbox import Message


@dataclass
class Members:
    """`clients` are all of them, also the verb."""

    clients: list[Client] = field(default_factory=list)
    driver: Client | None = None
    verb: Client | None = None

    @property
    def pages(self) -> list[Client]:
        return [client for client in self.clients if client.verb is None]

    def is_driven_by(self, page: str) -> bool:
        """True where the page of this name drives."""
        return self.driver is not None and self.driver.id == page

    def add(self, client: Client) -> None:
        self.clients.append(client)
        if client.verb is not None:
            self.verb = client

    def remove(self, client: Client) -> None:
        self.clients.remove(client)
        if client is self.verb:
            self.verb = None

    def tell(self, message: Message, but: Client | None = None) -> None:
        """Say something to all pages but one."""
        for page in self.pages:
            if page is not but:
                page.outbox.add_answer(message)

    def tell_driver(self) -> None:
        """Say to each page whether it drives, and which verb uses the board."""
        job, verb = (None, None) if self.verb is None else (self.verb.id, self.verb.verb)
        for page in self.pages:
            you, free = page is self.driver, self.driver is None
            page.outbox.add_answer({"kind": "driver", "you": you, "free": free, "job": job, "verb": verb})
