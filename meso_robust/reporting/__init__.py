"""Reports for people."""


def report(r):
    return "<html></html>"
