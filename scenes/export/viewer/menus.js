// Buttons that open a menu below them.

/** A menu that a button opens; it closes with escape, a choice or a press elsewhere, and stays within the window. */
export function setUpMenu(button, menu) {
  const show = (open) => {
    button.setAttribute('aria-expanded', open);
    menu.hidden = !open;
    if (!open) return;
    const own = button.getBoundingClientRect(), all = menu.parentElement.getBoundingClientRect();
    menu.style.top = `${own.bottom - all.top + 6}px`;
    menu.style.maxHeight = `${all.bottom - own.bottom - 12}px`;
    menu.style.overflow = 'auto';
    menu.style.left = `${Math.max(8, Math.min(own.left - all.left, all.width - menu.offsetWidth - 8))}px`;
    menu.querySelector('button:not(:disabled)')?.focus();
  };
  button.onclick = () => show(menu.hidden);
  menu.addEventListener('click', (event) => { if (event.target.closest('button')) show(false); });
  document.addEventListener('pointerdown', (event) => {
    if (!menu.hidden && !menu.contains(event.target) && !button.contains(event.target)) show(false);
  });
  menu.addEventListener('keydown', (event) => {
    if (event.key !== 'Escape' && event.key !== 'ArrowDown' && event.key !== 'ArrowUp') return;
    event.preventDefault();
    event.stopPropagation();
    if (event.key === 'Escape') {
      show(false);
      return button.focus();
    }
    const items = [...menu.querySelectorAll('button:not(:disabled)')], at = items.indexOf(document.activeElement);
    items[(at + (event.key === 'ArrowDown' ? 1 : items.length - 1)) % items.length].focus();
  });
}
